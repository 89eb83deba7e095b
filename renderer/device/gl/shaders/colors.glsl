// A sample's colour, as the cpu device finds it (kernels/project.hpp, resolve.hpp). Needs `pass.ramp`, RunParams and
// splat_tables.glsl. Variant: COLORING.

uint rampColor(float index) {
    precise float nearest = clamp(index, 0.0, 255.0) + 0.5;
    return tables[rampWords + uint(nearest)];
}

// r | g << 8 | b << 16
uint colorOf(RunParams run, uvec4 words, float depth) {
#if COLORING == COLOR_RGB
    return words.z & 0xffffffu;
#elif COLORING == COLOR_PER_RUN
    return run.color.x;
#elif COLORING == COLOR_INTENSITY
    precise float index = (float(words.y >> 16) - pass.ramp.x) * pass.ramp.y;
    return rampColor(index);
#elif COLORING == COLOR_ELEVATION
    precise float index = float(words.y & 0xffffu) * run.factors.x + run.factors.y;
    return rampColor(index);
#elif COLORING == COLOR_CLASSIFICATION
    return tables[rampWords + (words.z >> 24)];
#elif COLORING == COLOR_NORMAL
    return tables[normalWords + (words.w & 0xffffu)];
#else
    precise float index = (depth - pass.ramp.x) * pass.ramp.y;
    return rampColor(index);
#endif
}
