// Labels of hidden points as colours: docs/spec/pyramid.md section 4.5. Visible background stays.
#version 450 core
#include "layouts_screen.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { VisibilityParams params; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 3) readonly buffer Labels { uint labels[]; };

const uint hiddenLabel = 0u, foregroundLabel = 1u;
// Depths above it are infinite.
const float finiteDepths = 3.4e38;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, params.size.xy))) return;
    int i = at.y * params.size.x + at.x;
    if (labels[i] == foregroundLabel) colors[i] = params.colors.x;
    if (labels[i] == hiddenLabel) colors[i] = depths[i] > finiteDepths ? params.colors.z : params.colors.y;
}
