// resolve: nearest keys -> colour; the background where no key is. Depth needs no pass: an order's bits are a float,
// and an empty pixel's are infinity.
#version 450 core
#include "layouts.glsl"

layout(local_size_x = 16, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PassParams pass; };
layout(std430, binding = 4) readonly buffer Orders { uint orders[]; };
layout(std430, binding = 5) readonly buffer Payloads { uint payloads[]; };
layout(std430, binding = 6) readonly buffer Background { uint background[]; };  // one rgba per row of the area
layout(std430, binding = 7) writeonly buffer Resolved { uint resolved[]; };

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.area.zw))) return;
    uint pixel = uint(at.y * pass.area.z + at.x);
    bool covered = orders[pixel] < 0x7f800000u;
    resolved[pixel] = covered ? payloads[pixel] | 0xff000000u : background[at.y];
}
