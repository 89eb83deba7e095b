// Eye-dome lighting from depth alone (docs/spec/shading.md section 3), in place, as the cpu device computes it
// (kernels/screen.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "formulas.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { EyeDomeLight pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) readonly buffer Depths { float depths[]; };

#include "light.inl"
#include "powers.inl"

const float background = 3.4e38;

// How much nearer a neighbour lies, in octaves; beyond the planes lies background, which adds nothing.
float response(float own, ivec2 at) {
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, pass.size.xy))) return 0.0;
    float depth = depths[at.y * pass.size.x + at.x];
    if (depth > background) return 0.0;
    precise float rise = own - log2Of(depth);
    return rise > 0.0 ? rise : 0.0;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    float depth = depths[pixel];
    if (depth > background) return;
    float own = log2Of(depth);
    precise float sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        sum += response(own, at + pass.offsets[k].xy);
        sum += response(own, at + pass.offsets[k].zw);
    }
    precise float exponent = -(pass.strength.x * sum);
    float shade = exp2Of(exponent);
    colors[pixel] = uint(shaded(int(colors[pixel]), shade));
}
