// Adding fragments up, exactly: 64-bit integers out of two 32-bit words each, the lower one's atomicAdd telling when to
// carry. Of each pixel Σw, Σw·r, Σw·g, Σw·b and, with normals, Σw·(x + s), Σw·(y + s), Σw·(z + s) of the view-space normal
// times s = 255: shifted, so that nothing is negative and carries are rare; resolving takes s·Σw off again.
// Variant: SUM_NORMALS.
const int largestWeight = 4095;
const float normalSteps = 255.0;
#if SUM_NORMALS
const uint planes = 7u;
#else
const uint planes = 4u;
#endif

layout(std430, binding = 4) buffer Sums { uint sums[]; };

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

void addTo(uint word, uint value) {
    if (value == 0u) return;
    uint before = atomicAdd(sums[word], value);
    if (before + value < before) atomicAdd(sums[word + 1u], 1u);
}

// `weight` in [0, 1]; 12 bits of it, at least 1. The normal the other way round where `turned`.
void addFragment(uint pixel, float weight, Addends addends, bool turned) {
    precise float scaled = weight * float(largestWeight) + 0.5;
    uint whole = uint(max(int(scaled), 1));
    uint word = pixel * (2u * planes);
    addTo(word, whole);
    for (uint c = 0u; c < 3u; ++c) addTo(word + 2u + 2u * c, whole * addends.color[c]);
#if SUM_NORMALS
    uvec3 normal = turned ? 2u * uint(normalSteps) - addends.normal : addends.normal;
    for (uint c = 0u; c < 3u; ++c) addTo(word + 8u + 2u * c, whole * normal[c]);
#endif
}
