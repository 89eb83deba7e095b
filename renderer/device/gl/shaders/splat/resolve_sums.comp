// resolve, last step: means of sums instead of what is there, wherever there is a key and something was added.
// Variants: KEYS64, SUM_NORMALS, NORMALS 0 or 1.
#version 450 core
#include "layouts_splat.glsl"
#include "exact.glsl"
#include "resolve_area.glsl"
#include "read_keys.glsl"
#include "normal_plane.glsl"

layout(std430, binding = 3) readonly buffer Sums { uint sums[]; };  // sums.glsl
layout(std430, binding = 6) buffer Rgba { uint rgba[]; };
#if NORMALS
layout(std430, binding = 7) buffer Normals { uint normals[]; };
#endif
const uint planes = SUM_NORMALS == 1 ? 7u : 4u;

// low word, high word
uvec2 sumAt(uint pixel, uint plane) {
    uint word = (pixel * planes + plane) * 2u;
    return uvec2(sums[word], sums[word + 1u]);
}

// To the nearest float, ties to even: of a large number the upper 32 bits, whose lowest tells whether any below are set.
float toFloat(uvec2 v) {
    if (v.y == 0u) return float(v.x);
    int shift = findMSB(v.y) + 1;
    uint top = shift == 32 ? v.y : v.y << (32 - shift) | v.x >> shift;
    uint below = shift == 32 ? v.x : v.x & ((1u << shift) - 1u);
    return float(top | (below != 0u ? 1u : 0u)) * uintBitsToFloat(uint(127 + shift) << 23);
}

uvec2 minus(uvec2 a, uvec2 b) {
    return uvec2(a.x - b.x, a.y - b.y - (a.x < b.x ? 1u : 0u));
}

// Of a plane that was shifted by 255 Σw so that it is never negative.
float signedSum(uvec2 shifted, uvec2 weight) {
    uint high, low;
    umulExtended(weight.x, 255u, high, low);
    uvec2 shift = uvec2(low, high + weight.y * 255u);
    bool negative = shifted.y < shift.y || (shifted.y == shift.y && shifted.x < shift.x);
    float magnitude = toFloat(negative ? minus(shift, shifted) : minus(shifted, shift));
    return negative ? -magnitude : magnitude;
}

void main() {
    ivec2 at;
    uint pixel, place;
    if (!pixelHere(at, pixel, place)) return;
    uvec2 weight = sumAt(pixel, 0u);
    if (keyOrder(pixel) >= infiniteOrder || (weight.x | weight.y) == 0u) return;
    float inverse = quotient(1.0, toFloat(weight));
    uint mean = 0xff000000u;
    for (uint c = 0u; c < 3u; ++c) {
        precise float channel = toFloat(sumAt(pixel, 1u + c)) * inverse + 0.5;
        mean |= uint(channel) << (8u * c);
    }
    rgba[place] = mean;
#if NORMALS
    vec3 sum = vec3(signedSum(sumAt(pixel, 4u), weight), signedSum(sumAt(pixel, 5u), weight),
                    signedSum(sumAt(pixel, 6u), weight));
    uint normal = packNormal(sum);
    if (normal != 0u) normals[place] = normal;
#endif
}
