// Adding fragments up, exactly, in 64-bit integers: where the driver has 64-bit atomics by one that returns nothing, elsewhere
// in two 32-bit words, the lower one's atomicAdd telling when to carry. Of each pixel Σw, Σw·r, Σw·g, Σw·b and, with normals,
// Σw·(x + s), Σw·(y + s), Σw·(z + s) of the view-space normal times s = 255: shifted, so that nothing is negative and carries are
// rare; resolving takes s·Σw off again.
//
// Pixels of the group's tile are added up in shared memory before, all others at once; which are, decides
// nothing but how long it takes. Variants: SUM_NORMALS, SUM_TILE (a tile's pixels, or 0), GROUP_SIZE,
// KEYS64, COUNT_ADDS; SUM_SIDE, of the largest square in a tile.
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
// A work group's tile: a rectangle of pixels in shared memory, where fragments of its samples are added up before each
// pixel that any of them touched is added to the picture's sums, once. 32 bits hold a tile's sums exactly, without carries: a
// sample has one fragment a pixel, at most, so that there are CHUNK_SAMPLES, and CHUNK_SAMPLES * 4095 * 510 < 2^31.
//
// A chunk's samples lie side by side, for the most part; where they need more pixels than a tile has, they are taken part by
// part, each with its tile. What lies outside a tile all the same is added straight to the picture's sums (sums.glsl).
const uint outsideTile = 0xffffffffu;
// Samples that share a tile, at least; else too few threads have work.
const uint leastPart = 64u;
// Of a footprint, px from its centre: what a tile makes room for. Larger ones are few.
const float mostHalf = 8.0;

shared uint cells[planes * SUM_TILE];  // plane by plane
// Of the samples' footprints: the first pixel, and the last one's negative, each x, y; and how many samples there are.
shared int bounds[4];
shared uint boundSamples;

ivec4 tile = ivec4(0);  // x, y, width, height, px in the whole picture

uint cellOf(ivec2 at) {
    uvec2 place = uvec2(at - tile.xy);  // what is left of it or above is far beyond it
    return place.x < uint(tile.z) && place.y < uint(tile.w) ? place.y * uint(tile.z) + place.x : outsideTile;
}

void addToTile(uint cell, uint plane, uint value) {
    if (value != 0u) atomicAdd(cells[plane * SUM_TILE + cell], value);
}

// Samples of about so many pixels share a tile: all `count` of them if they fit.
uint partOf(uint count) {
    uint area = uint(max(1 - bounds[2] - bounds[0], 0)) * uint(max(1 - bounds[3] - bounds[1], 0));
    uint part = count;
    // Half of the samples have, roughly, half of the pixels.
    for (; area > SUM_TILE && part > leastPart; area /= 2u) part = (part + 1u) / 2u;
    return part;
}

// Where the bounds are, cut to what fits around their middle; nothing where samples are so few that emptying a tile is more work
// than adding their fragments.
void setTile() {
    ivec2 first = ivec2(bounds[0], bounds[1]);
    ivec2 size = max(1 - ivec2(bounds[2], bounds[3]) - first, ivec2(0));
    if (size.x == 0 || size.y == 0 || boundSamples * 16u < min(uint(size.x * size.y), uint(SUM_TILE))) {
        tile = ivec4(0);
        return;
    }
    ivec2 most = size;
    if (size.x * size.y > SUM_TILE) {
        // As wide as it is high, unless one of both is less than that.
        int width = size.x;
        int height = min(size.y, max(SUM_SIDE, SUM_TILE / width));
        most = ivec2(min(size.x, SUM_TILE / height), height);
    }
    tile = ivec4(first + ((size - most) >> 1), most);
}

void emptyTile() {
    uint pixels = uint(tile.z * tile.w);
    for (uint i = gl_LocalInvocationID.x; i < pixels; i += GROUP_SIZE) {
        for (uint c = 0u; c < planes; ++c) cells[c * SUM_TILE + i] = 0u;
    }
}

// To the picture's sums.
void addTile() {
    uint pixels = uint(tile.z * tile.w);
    uint width = uint(tile.z);
    for (uint i = gl_LocalInvocationID.x; i < pixels; i += GROUP_SIZE) {
        uint weight = cells[i];
        if (weight == 0u) continue;
        ivec2 place = tile.xy - pass.area.xy + ivec2(i % width, i / width);
        uint sum = uint(place.y * pass.area.z + place.x) * planes;
        addTo(sum, weight);
        for (uint c = 1u; c < planes; ++c) addTo(sum + c, cells[c * SUM_TILE + i]);
#if COUNT_ADDS
        atomicAdd(counts[2], 1u);
#endif
    }
}
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
