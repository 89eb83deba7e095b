// The orders that the nearest pass left: depths of what is visible. Variant: KEYS64.
layout(binding = 3) uniform usamplerBuffer visible;

uint visibleOrder(uint pixel) {
#if KEYS64
    return texelFetch(visible, int(pixel)).y;
#else
    return texelFetch(visible, int(pixel)).x;
#endif
}
