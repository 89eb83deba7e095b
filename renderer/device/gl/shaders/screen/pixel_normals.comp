// Normals of the picture's pixels, each between the two levels that its distance calls for. docs/spec/pyramid.md section 6;
// as the cpu device computes it (kernels/depth_normals.hpp).
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "formulas.glsl"
#include "pyramid.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 2) writeonly buffer Normals { uint normals[]; };
layout(std430, binding = 5) readonly buffer LevelNormals { vec4 levelNormals[]; };

// Of the picture only: its normals are nobody else's, so they are made here.
float depthAt(int level, ivec2 at) {
    return depths[pixelOf(at)];
}

#include "normal_plane.glsl"
#include "powers.inl"
#include "surface_normal.glsl"

// A level's bilinear value; level >= 1.
vec3 levelValue(int level, ivec2 at) {
    ivec2 size = sizeOf(level);
    float texels = intBitsToFloat((127 - level) << 23);  // 1 / 2^level
    precise vec2 place = (vec2(at) + 0.5) * texels - 0.5;
    precise vec2 f = place - floor(place);
    ivec2 before = ivec2(floor(place)), first = max(before, ivec2(0)), second = min(before + 1, size - 1);
    vec3 a = levelNormals[placeOf(level, first)].xyz;
    vec3 b = levelNormals[placeOf(level, ivec2(second.x, first.y))].xyz;
    vec3 c = levelNormals[placeOf(level, ivec2(first.x, second.y))].xyz;
    vec3 d = levelNormals[placeOf(level, second)].xyz;
    precise vec3 above = a + (b - a) * f.x;
    precise vec3 below = c + (d - c) * f.x;
    precise vec3 value = above + (below - above) * f.y;
    return value;
}

// The level that a depth calls for.
float levelOf(float depth) {
    float size = quotient(pyramid.normals.x, perspective() ? depth : 1.0);
    float wished = log2Of(size > pyramid.normals.y ? size : pyramid.normals.y);
    float last = float(pyramid.normalLevels.y - 1);
    wished = wished > 0.0 ? wished : 0.0;
    return wished < last ? wished : last;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!inside(at, pyramid.size.xy)) return;
    float depth = depths[pixelOf(at)];
    uint code = 0u;
    if (depth < finiteDepths) {
        float level = levelOf(depth);
        int first = int(level);
        precise vec3 sum = vec3(0.0);
        for (int k = first; k <= first + 1; ++k) {
            precise float weight = 1.0 - abs(level - float(k));
            if (weight > 0.0) sum += weight * (k == 0 ? normalAt(0, at) : levelValue(k, at));
        }
        code = packNormal(sum);
    }
    normals[pixelOf(at)] = code;
}
