// Sums of the window's colours over frames: 16 bits a channel, so 257 frames at most.
#version 450 core
#include "layouts_screen.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PartParams part; };
layout(std430, binding = 0) readonly buffer Plane { uint plane[]; };
layout(std430, binding = 1) buffer RedBlue { uint redBlue[]; };
layout(std430, binding = 2) buffer GreenAlpha { uint greenAlpha[]; };

void main() {
    ivec2 own = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(own, part.window.zw))) return;
    ivec2 at = own + part.window.xy - part.area.xy;
    uint rgba = plane[at.y * part.area.z + at.x];
    int pixel = own.y * part.window.z + own.x;
    bool first = part.frames.x == 0u;
    redBlue[pixel] = (first ? 0u : redBlue[pixel]) + (rgba & 0x00ff00ffu);
    greenAlpha[pixel] = (first ? 0u : greenAlpha[pixel]) + ((rgba >> 8) & 0x00ff00ffu);
}
