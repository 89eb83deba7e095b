// Normals of all levels but the picture's, one after another in the work groups: docs/spec/pyramid.md section 6.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "pyramid.glsl"

layout(local_size_x = 256) in;

layout(std430, binding = 4) readonly buffer Filled { vec4 filled[]; };
layout(std430, binding = 5) writeonly buffer LevelNormals { vec4 levelNormals[]; };

float depthAt(int level, ivec2 at) {
    return filled[placeOf(level, at)].x;
}

#include "surface_normal.glsl"

void main() {
    int level = pyramid.normalLevels.x, last = pyramid.normalLevels.y - 1;
    int place = pyramid.levels[level].z + int(gl_GlobalInvocationID.x);
    while (level < last && place >= pyramid.levels[level + 1].z) ++level;
    int own = place - pyramid.levels[level].z, width = pyramid.levels[level].x;
    ivec2 at = ivec2(own % width, own / width);
    if (at.y < pyramid.levels[level].y) levelNormals[place] = vec4(normalAt(level, at), 0.0);
}
