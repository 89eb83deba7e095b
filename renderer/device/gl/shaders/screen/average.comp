// The mean of frames from their sums: colour weighted by coverage, straight alpha; as the cpu device computes it
// (kernels/screen.hpp).
#version 450 core
#include "layouts_screen.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PartParams part; };
layout(std430, binding = 0) writeonly buffer Mean { uint mean[]; };
layout(std430, binding = 1) readonly buffer RedBlue { uint redBlue[]; };
layout(std430, binding = 2) readonly buffer GreenAlpha { uint greenAlpha[]; };

void main() {
    ivec2 own = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(own, part.window.zw))) return;
    int pixel = own.y * part.window.z + own.x;
    uvec2 odd = uvec2(redBlue[pixel] & 0xffffu, redBlue[pixel] >> 16);
    uvec2 even = uvec2(greenAlpha[pixel] & 0xffffu, greenAlpha[pixel] >> 16);
    uint divisor = max(even.y / 255u, 1u);
    uvec3 color = (uvec3(odd.x, even.x, odd.y) + divisor / 2u) / divisor;
    uint alpha = (even.y + part.frames.x / 2u) / part.frames.x;
    // As bytes: where some frame's alpha is neither 0 nor 255, a mean may be larger.
    mean[pixel] = (color.x & 255u) | (color.y & 255u) << 8 | (color.z & 255u) << 16 | alpha << 24;
}
