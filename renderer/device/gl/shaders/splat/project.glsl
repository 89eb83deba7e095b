// First half of a splat pass: a sample's words -> place on the picture, depth, size. Operation by operation what the cpu
// device computes (kernels/project.hpp), in the same order, so that both draw the same picture. Needs `pass`, RunParams,
// exact.glsl, splat_tables.glsl and sample_places.glsl. Variants: PERSPECTIVE, FILTERS 0 or 1.

struct Placed {
    float x, y;    // px in the whole picture
    float depth;
    float ratio;   // of the sample's radius to the run's plain one
    float halfPx;  // half a sprite's size, px
};

const uint outlierCode = 255u, twoSidedCircle = 1u;
const float outsidePx = 1048576.0;  // far outside any picture, and still exact as an integer

#if FILTERS
float tableFloat(uint word) { return uintBitsToFloat(tables[word]); }

bool insideRegion(uint word, vec3 p) {
    uint planes = tables[word];
    for (uint i = 0u; i < planes; ++i) {
        uint row = word + 1u + 4u * i;
        precise float above = tableFloat(row) * p.x +
                              (tableFloat(row + 1u) * p.y + (tableFloat(row + 2u) * p.z + tableFloat(row + 3u)));
        if (!(above >= 0.0)) return false;
    }
    return true;
}

bool passesFilters(RunParams run, uvec4 words) {
    if (pass.filters.x != 0 && tables[classWords + (words.z >> 24)] == 0u) return false;
    ivec3 place = ivec3(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu);
    if (any(lessThan(place, run.clipMin.xyz)) || any(greaterThan(place, run.clipMax.xyz))) return false;
    uint dropped = uint(run.clipMax.w) & 0xffffu, kept = uint(run.clipMax.w) >> 16;
    uint word = uint(run.clipMin.w);
    for (uint r = 0u; r < dropped; ++r, word += regionWords) {
        if (insideRegion(word, vec3(place))) return false;
    }
    for (uint r = 0u; r < kept; ++r, word += regionWords) {
        if (insideRegion(word, vec3(place))) return true;
    }
    return kept == 0u;
}
#endif

// Whether the sign of its normal means something; else it is turned to the eye.
bool isOneSided(RunParams run, uvec4 words) { return (run.color.w & 1u) != 0u && (words.w >> 24) != twoSidedCircle; }

// Of the pass. Not by its index: a vector that is indexed by what only the GPU knows is put into slow memory by some compilers,
// and the whole run with it.
float sizeFactor(vec4 factors) {
    int stage = pass.flags.x;
    return stage == 0 ? factors.x : stage == 1 ? factors.y : stage == 2 ? factors.z : factors.w;
}

// False: it is not drawn.
bool placeSample(RunParams run, uvec4 words, out Placed placed) {
    vec3 centre = centreOf(run, words);
    float depth = centre.z;
    if (!(depth >= pass.view.z && depth <= pass.view.w)) return false;
    if (pass.filters.y == 0 && ((words.w >> 16) & 255u) == outlierCode) return false;
#if FILTERS
    if (!passesFilters(run, words)) return false;
#endif
#if PERSPECTIVE
    float inverse = quotient(1.0, depth);
#else
    float inverse = 1.0;
#endif
    precise float x = pass.view.x + centre.x * inverse;
    precise float y = pass.view.y + centre.y * inverse;
    placed.ratio = radiusRatio(run, words, pass.flags.w != 0);
    precise float wanted = sizeFactor(run.sizeFactors) * placed.ratio;
    precise float size = wanted * inverse;
    placed.x = clamp(x, -outsidePx, outsidePx);
    placed.y = clamp(y, -outsidePx, outsidePx);
    placed.depth = depth;
    placed.halfPx = 0.5 * clamp(size, pass.size.x, pass.size.y);
    return true;
}
