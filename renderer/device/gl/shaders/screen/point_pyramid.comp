// The pyramid of points that hidden point removal looks at: of each 2 x 2 the point with the least depth, the first in
// reading order among equals. docs/spec/pyramid.md section 3; as the cpu device computes it (kernels/point_pyramid.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "pyramid.glsl"
#include "unproject.glsl"

layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 4) buffer Above { vec4 above[]; };

#include "reduce.glsl"

vec4 fineTexel(int base, ivec2 at) {
    if (!inside(at, sizeOf(base))) return nothing;
    if (base > 0) return above[placeOf(base, at)];
    return pointOf(vec2(at), depths[pixelOf(at)]);
}

vec4 mergedOf(vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 nearest = a;
    if (b.x < nearest.x) nearest = b;
    if (c.x < nearest.x) nearest = c;
    if (d.x < nearest.x) nearest = d;
    return nearest;
}

void main() {
    reduce();
}
