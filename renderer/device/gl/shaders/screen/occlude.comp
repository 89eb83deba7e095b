// Ambient occlusion from depth alone (docs/spec/shading.md section 9), in place, as the cpu device computes it
// (kernels/occlusion.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "formulas.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { OcclusionParams pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) readonly buffer Depths { float depths[]; };

#include "light.inl"
#include "powers.inl"

const float background = 3.4e38;

// What is nearer is larger, and linear over a plane.
float nearness(float depth) {
    return pass.strength.y != 0.0 ? quotient(1.0, depth) : -depth;
}

// Beyond the planes lies background.
float depthAt(ivec2 at) {
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, pass.size.xy))) return 3.402823e38;
    return depths[at.y * pass.size.x + at.x];
}

// How far a side lies beyond what can occlude, 0 to 1.
float beyond(float side) {
    precise float b = (side - occlusionFull) * occlusionFall;
    b = b > 0.0 ? b : 0.0;
    return b < 1.0 ? b : 1.0;
}

// How steeply two opposite neighbours rise above the plane through a pixel.
float hollow(ivec2 a, ivec2 b, float own, float slope) {
    float depthA = depthAt(a), depthB = depthAt(b);
    bool knownA = !(depthA > background), knownB = !(depthB > background);
    precise float riseA = 0.0, riseB = 0.0;
    if (knownA) riseA = (nearness(depthA) - own) * slope;
    if (knownB) riseB = (nearness(depthB) - own) * slope;
    // Of the background nothing is known: the surface goes on there.
    float sideA = knownA ? riseA : -riseB, sideB = knownB ? riseB : -riseA;
    precise float mean = 0.5 * (sideA + sideB) * (1.0 - beyond(sideA) - beyond(sideB));
    mean = mean > 0.0 ? mean : 0.0;
    return mean < 1000.0 ? mean : 1000.0;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    float depth = depths[pixel];
    if (depth > background) return;
    float own = nearness(depth);
    float scale = pass.strength.y != 0.0 ? depth : 1.0;
    precise float sum = 0.0;
    for (int k = 0; k < occlusionPairs; ++k) {
        ivec2 offset = pass.pairs[k].xy;
        precise float slope = scale * intBitsToFloat(pass.pairs[k].z);
        float h = hollow(at + offset, at - offset, own, slope);
        precise float square = h * h;
        precise float above = 1.0 + square;
        sum += quotient(square, above);
    }
    precise float exponent = -(pass.strength.x * sum);
    float shade = exp2Of(exponent);
    colors[pixel] = uint(shaded(int(colors[pixel]), shade));
}
