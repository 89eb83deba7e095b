// Distances along columns to the nearest point, or to what no point covers. docs/spec/pyramid.md section 4.4; as the cpu
// device computes it (kernels/closing.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "pyramid.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std430, binding = 1) readonly buffer Depths { float depths[]; };

#include "closing.glsl"

bool found(ivec2 at) {
    if (!inside(at, pyramid.size.xy)) return false;
    return baseLevel == 0u ? depths[pixelOf(at)] < finiteDepths : closing[coveredPlace(at)] == 0;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!inside(at, pyramid.size.xy)) return;
    int steps = 0;
    while (steps <= pyramid.blocks.z && !found(at + ivec2(0, steps)) && !found(at - ivec2(0, steps))) ++steps;
    closing[distancePlace(at)] = steps;
}
