// The window's part of a plane, row by row.
#version 450 core
#include "layouts_screen.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PartParams part; };
layout(std430, binding = 0) readonly buffer Plane { uint plane[]; };
layout(std430, binding = 1) writeonly buffer Cropped { uint cropped[]; };

void main() {
    ivec2 own = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(own, part.window.zw))) return;
    ivec2 at = own + part.window.xy - part.area.xy;
    cropped[own.y * part.window.z + own.x] = plane[at.y * part.area.z + at.x];
}
