// A sample's colour, as the cpu device finds it (kernels/project.hpp, resolve.hpp). Needs `pass.ramp`, RunParams and
// splat_tables.glsl. Variants: COLORING, BY_INTENSITY.

#if COLORING == COLOR_CURVATURE || COLORING == COLOR_INFRARED
#include "beside.glsl"
#endif

// The nearest of 256 entries from word `first` on.
uint tableEntry(uint first, float index) {
    precise float nearest = clamp(index, 0.0, 255.0) + 0.5;
    return tables[first + uint(nearest)];
}

// Each channel by itself.
uint toned(uint color) {
    uvec3 rgb = rampWords + ((uvec3(color) >> uvec3(0, 8, 16)) & 0xffu);
    return (tables[rgb.x] & 0xffu) | (tables[rgb.y] & 0xff00u) | (tables[rgb.z] & 0xff0000u);
}

// r | g << 8 | b << 16; `beside`: the word of its page that stands beside the sample.
uint sourceColor(RunParams run, uvec4 words, uint beside, float depth) {
#if COLORING == COLOR_RGB
    return words.z & 0xffffffu;
#elif COLORING == COLOR_PER_RUN
    return run.color.x;
#elif COLORING == COLOR_INTENSITY
    precise float index = (float(words.y >> 16) - pass.ramp.x) * pass.ramp.y;
    return tableEntry(rampWords, index);
#elif COLORING == COLOR_ELEVATION
    precise float index = float(words.y & 0xffffu) * run.factors.x + run.factors.y;
    return tableEntry(rampWords, index);
#elif COLORING == COLOR_CLASSIFICATION
    return tables[rampWords + (words.z >> 24)];
#elif COLORING == COLOR_NORMAL
    return tables[normalWords + (words.w & 0xffffu)];
#elif COLORING == COLOR_CURVATURE
    uint code = besideAt(run, beside);
    precise float sum = uintBitsToFloat(tables[curvatureWords + (code & 255u)]) +
                        uintBitsToFloat(tables[curvatureWords + ((code >> 8) & 255u)]);
    precise float index = sum * run.factors.x + run.factors.y;
    return tableEntry(rampWords, index);
#elif COLORING == COLOR_TONED
    return toned(words.z);
#elif COLORING == COLOR_INFRARED
    return toned(besideAt(run, beside) >> 24 | (words.z & 0xffffu) << 8);
#else
    precise float index = (depth - pass.ramp.x) * pass.ramp.y;
    return tableEntry(rampWords, index);
#endif
}

uint colorOf(RunParams run, uvec4 words, uint beside, float depth) {
    uint color = sourceColor(run, words, beside, depth);
#if BY_INTENSITY
    precise float index = (float(words.y >> 16) - pass.ramp.z) * pass.ramp.w;
    uint factor = tableEntry(factorWords, index);
    uvec3 rgb = ((uvec3(color) >> uvec3(0, 8, 16)) & 0xffu) * factor + 128u;
    rgb = min(rgb >> 8, uvec3(255));
    color = rgb.x | rgb.y << 8 | rgb.z << 16;
#endif
    return color;
}
