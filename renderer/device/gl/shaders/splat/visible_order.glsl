// The orders that the nearest pass left: depths of what is visible. Variant: KEYS64.
layout(binding = 3) uniform usamplerBuffer visible;

#if KEYS64
uint visiblePayload(uint pixel) { return texelFetch(visible, int(pixel)).x; }
#else
layout(binding = 2) uniform usamplerBuffer visiblePayloads;
uint visiblePayload(uint pixel) { return texelFetch(visiblePayloads, int(pixel)).x; }
#endif

uint visibleOrder(uint pixel) {
#if KEYS64
    return texelFetch(visible, int(pixel)).y;
#else
    return texelFetch(visible, int(pixel)).x;
#endif
}
