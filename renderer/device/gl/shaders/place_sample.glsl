// First half of a splat pass: a sample's words -> place on the picture, depth, size, colour. Operation by operation
// what the cpu device computes (kernels/project.hpp), in the same order, so that both draw the same picture.
// Variants: PERSPECTIVE 0 or 1, COLORING (one of COLOR_...), CLASSES 0 or 1, CLIPPED 0 or 1.

struct Splat {
    bool drawn;
    float x, y;    // px in the whole picture
    float depth;
    float halfPx;  // half its size, px
};

const float outsidePx = 1048576.0;  // far outside any picture, and still exact as an integer

bool passesFilters(RunParams run, uvec4 words) {
#if CLASSES
    if (colorTable[256u + (words.z >> 24)] == 0u) return false;
#endif
#if CLIPPED
    ivec3 place = ivec3(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu);
    if (any(lessThan(place, run.clipMin.xyz)) || any(greaterThan(place, run.clipMax.xyz))) return false;
#endif
    return true;
}

// Of the sample's radius to its node's; 1 where no radius is known.
float radiusRatio(RunParams run, uvec4 words) {
    float radius = uintBitsToFloat(colorTable[512u + ((words.w >> 16) & 255u)]);
    precise float ratio = radius * run.factors.w;
    return ratio > 0.0 ? ratio : 1.0;
}

Splat placeSample(PassParams pass, RunParams run, uvec4 words) {
    Splat splat;
    float sx = float(words.x & 0xffffu);
    float sy = float(words.x >> 16);
    float sz = float(words.y & 0xffffu);
    vec4 a = run.toPicture[0], b = run.toPicture[1], c = run.toPicture[2];
    precise float depth = c.x * sx + (c.y * sy + (c.z * sz + c.w));
    splat.drawn = depth >= pass.view.z && depth <= pass.view.w && passesFilters(run, words);
    precise float across = a.x * sx + (a.y * sy + (a.z * sz + a.w));
    precise float down = b.x * sx + (b.y * sy + (b.z * sz + b.w));
    float d = splat.drawn ? depth : 1.0;
#if PERSPECTIVE
    precise float inverse = 1.0 / d;
#else
    precise float inverse = 1.0;
#endif
    precise float x = pass.view.x + across * inverse;
    precise float y = pass.view.y + down * inverse;
    precise float wanted = run.factors.x * radiusRatio(run, words);
    precise float size = wanted * inverse;
    splat.x = clamp(x, -outsidePx, outsidePx);
    splat.y = clamp(y, -outsidePx, outsidePx);
    splat.depth = d;
    splat.halfPx = 0.5 * clamp(size, pass.size.x, pass.size.y);
    return splat;
}

uint rampColor(float index) {
    precise float nearest = clamp(index, 0.0, 255.0) + 0.5;
    return colorTable[uint(nearest)];
}

// r | g << 8 | b << 16
uint colorOf(PassParams pass, RunParams run, uvec4 words, float depth) {
#if COLORING == COLOR_RGB
    return words.z & 0xffffffu;
#elif COLORING == COLOR_PER_RUN
    return run.color.x;
#elif COLORING == COLOR_INTENSITY
    precise float index = (float(words.y >> 16) - pass.ramp.x) * pass.ramp.y;
    return rampColor(index);
#elif COLORING == COLOR_ELEVATION
    precise float index = float(words.y & 0xffffu) * run.factors.y + run.factors.z;
    return rampColor(index);
#elif COLORING == COLOR_CLASSIFICATION
    return colorTable[words.z >> 24];
#elif COLORING == COLOR_NORMAL
    return colorTable[768u + (words.w & 0xffffu)];
#else
    precise float index = (depth - pass.ramp.x) * pass.ramp.y;
    return rampColor(index);
#endif
}
