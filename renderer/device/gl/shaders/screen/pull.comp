// The first half of pull-push: depth and colour of a texel are the means of its known children. docs/spec/pyramid.md section 5;
// as the cpu device computes it (kernels/pull_push.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "pyramid.glsl"

layout(std430, binding = 0) readonly buffer Colors { uint colors[]; };
layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 3) readonly buffer Labels { uint labels[]; };
layout(std430, binding = 5) buffer Above { vec4 above[]; };

#include "reduce.glsl"

const uint foreground = 1u;

vec4 fineTexel(int base, ivec2 at) {
    if (!inside(at, sizeOf(base))) return nothing;
    if (base > 0) return above[placeOf(base, at)];
    int pixel = pixelOf(at);
    if (labels[pixel] != foreground) return nothing;
    uint rgba = colors[pixel];
    return vec4(depths[pixel], float(rgba & 255u), float((rgba >> 8) & 255u), float((rgba >> 16) & 255u));
}

vec4 mergedOf(vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 children[4] = vec4[](a, b, c, d);
    precise vec4 sum = vec4(0.0);
    float count = 0.0;
    for (int i = 0; i < 4; ++i) {
        if (children[i].x < finiteDepths) {
            sum += children[i];
            count += 1.0;
        }
    }
    float share = quotient(1.0, count > 0.0 ? count : 1.0);
    precise vec4 mean = sum * share;
    return count > 0.0 ? mean : nothing;
}

void main() {
    reduce();
}
