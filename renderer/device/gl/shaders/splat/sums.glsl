// Adding fragments up, exactly, in 64-bit integers: where the driver has 64-bit atomics by one that returns nothing, elsewhere
// in two 32-bit words, the lower one's atomicAdd telling when to carry. Of each pixel Σw, Σw·r, Σw·g, Σw·b and, with normals,
// Σw·(x + s), Σw·(y + s), Σw·(z + s) of the view-space normal times s = 255: shifted, so that nothing is negative and carries are
// rare; resolving takes s·Σw off again.
//
// Pixels of the group's tile are added up in shared memory before (sum_tile.glsl), all others at once; which are, decides
// nothing but how long it takes. Variants: SUM_NORMALS, SUM_TILE, KEYS64, COUNT_ADDS.
const int largestWeight = 4095;
const float normalSteps = 255.0;
#if SUM_NORMALS
const uint planes = 7u;
#else
const uint planes = 4u;
#endif

#if KEYS64
layout(std430, binding = 4) buffer Sums { int64_t sums[]; };
#else
layout(std430, binding = 4) buffer Sums { uint sums[]; };
#endif
#if COUNT_ADDS
// For tests: fragments that went straight to the sums, those that went to tiles, pixels of tiles that were added to the sums.
layout(std430, binding = 7) buffer Counts { uint counts[]; };
#endif

// What a splat adds per unit of weight.
struct Addends {
    uvec3 color;
    uvec3 normal;
};

uint shifted(float v) {
    precise float rounded = v * normalSteps + (v < 0.0 ? -0.5 : 0.5);
    return uint(int(rounded) + int(normalSteps));
}

Addends addendsOf(uint color, vec3 normal) {
    return Addends(uvec3(color & 255u, (color >> 8) & 255u, (color >> 16) & 255u),
                   uvec3(shifted(normal.x), shifted(normal.y), shifted(normal.z)));
}

// To a pixel's sum of one plane; sum = pixel * planes + plane.
void addTo(uint sum, uint value) {
    if (value == 0u) return;
#if KEYS64
    atomicAdd(sums[sum], int64_t(value));
#else
    uint before = atomicAdd(sums[2u * sum], value);
    if (before + value < before) atomicAdd(sums[2u * sum + 1u], 1u);
#endif
}

#if SUM_TILE > 0
#include "sum_tile.glsl"
#endif

// `weight` in [0, 1]; 12 bits of it, at least 1. The normal the other way round where `turned`.
void addFragment(ivec2 at, uint pixel, float weight, Addends addends, bool turned) {
    precise float scaled = weight * float(largestWeight) + 0.5;
    uint whole = uint(max(int(scaled), 1));
#if SUM_NORMALS
    uvec3 normal = turned ? 2u * uint(normalSteps) - addends.normal : addends.normal;
#endif
#if SUM_TILE > 0
    uint cell = cellOf(at);
    if (cell != outsideTile) {
        addToTile(cell, 0u, whole);
        for (uint c = 0u; c < 3u; ++c) addToTile(cell, 1u + c, whole * addends.color[c]);
#if SUM_NORMALS
        for (uint c = 0u; c < 3u; ++c) addToTile(cell, 4u + c, whole * normal[c]);
#endif
#if COUNT_ADDS
        atomicAdd(counts[1], 1u);
#endif
        return;
    }
#endif
    uint sum = pixel * planes;
    addTo(sum, whole);
    for (uint c = 0u; c < 3u; ++c) addTo(sum + 1u + c, whole * addends.color[c]);
#if SUM_NORMALS
    for (uint c = 0u; c < 3u; ++c) addTo(sum + 4u + c, whole * normal[c]);
#endif
#if COUNT_ADDS
    atomicAdd(counts[0], 1u);
#endif
}
