// A mirror's glass (docs/spec/mirrors.md section 3), as the cpu device computes it (kernels/glass.hpp). THROUGH 1: where it is
// seen, the reflected pixels instead of what is there; 0: its tint, and its own depth.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "formulas.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { GlassParams glass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) buffer Depths { float depths[]; };
#if THROUGH
layout(std430, binding = 2) writeonly buffer Normals { uint normals[]; };
layout(std430, binding = 3) readonly buffer ReflectedColors { uint reflectedColors[]; };
layout(std430, binding = 4) readonly buffer ReflectedDepths { float reflectedDepths[]; };
layout(std430, binding = 5) readonly buffer ReflectedNormals { uint reflectedNormals[]; };
#endif

#include "light.inl"

float linearAt(vec4 values, vec2 pixel) {
    precise float value = (values.x + pixel.y * values.z) + pixel.x * values.y;
    return value;
}

// Whether a pixel of the whole picture sees the glass, and its depth there.
bool seesGlass(ivec2 at, float scene, out float depth) {
    vec2 pixel = vec2(at);
    bool perspective = glass.rightAt.w != 0.0;
    float linear = linearAt(glass.depthAt, pixel);
    float right = linearAt(glass.rightAt, pixel);
    float up = linearAt(glass.upAt, pixel);
    float edge = perspective ? linear : 1.0;
    bool inFront = linear > 0.0;
    float inverse = quotient(1.0, inFront ? linear : 1.0);
    depth = perspective ? inverse : linear;
    precise float front = depth - glass.depthAt.w;
    return inFront && right <= edge && right >= -edge && up <= edge && up >= -edge && front <= scene;
}

void main() {
    ivec2 own = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(own, glass.reflected.zw))) return;
    ivec2 at = glass.reflected.xy + own;
    int pixel = (at.y - glass.picture.y) * glass.picture.z + (at.x - glass.picture.x);
    float depth;
    if (!seesGlass(at, depths[pixel], depth)) return;
#if THROUGH
    int from = own.y * glass.reflected.z + own.x;
    colors[pixel] = reflectedColors[from];
    depths[pixel] = reflectedDepths[from];
    if (glass.tint.w != 0) normals[pixel] = reflectedNormals[from];
#else
    colors[pixel] = uint(throughGlass(int(colors[pixel]), glass.tint.x, glass.tint.y, glass.tint.z));
    depths[pixel] = depth;
#endif
}
