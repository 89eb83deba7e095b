// How the driver rounds: quotients, roots and conversions of given numbers, for the host to compare (arithmetic.hpp).
#version 450 core
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Given { uvec2 given[]; };     // a, b > 0
layout(std430, binding = 1) writeonly buffer Found { uvec4 found[]; };  // a / b, 1 / b, sqrt(a), float(bits of a * 977)

#include "exact.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(given.length())) return;
    float a = uintBitsToFloat(given[i].x), b = uintBitsToFloat(given[i].y);
    found[i] = uvec4(floatBitsToUint(quotient(a, b)), floatBitsToUint(quotient(1.0, b)), floatBitsToUint(root(a)),
                     floatBitsToUint(float(given[i].x * 977u)));
}
