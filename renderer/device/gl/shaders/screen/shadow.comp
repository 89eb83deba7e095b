// The sun's shadows, looked up in what it sees (docs/spec/shading.md section 10), as the cpu device computes it
// (kernels/shade.hpp).
#version 450 core
#include "layouts_screen.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { ShadowParams pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 4) readonly buffer Map { float map[]; };
layout(std430, binding = 5) writeonly buffer Sunlight { float sunlight[]; };

const float background = 3.4e38;

// A coordinate in the map, linear in pixels and depth.
float inMap(vec4 a, vec2 at, float depth) {
    precise float flat_ = a.x + a.y * at.x + a.z * at.y;
    precise float value = pass.map.z != 0 ? depth * flat_ + a.w : flat_ + a.w * depth;
    return value;
}

// Of three texels beside each other, whose weights change smoothly with the place.
float litOfRow(int place, float depth, float first, float last) {
    float a = map[place - 1] >= depth ? first : 0.0;
    float b = map[place] >= depth ? 0.5 : 0.0;
    float c = map[place + 1] >= depth ? last : 0.0;
    precise float lit = a + b + c;
    return lit;
}

// How much of the sun a pixel sees, 0 to 1.
float seenOfSun(vec2 at, float depth) {
    float u = inMap(pass.u, at, depth), v = inMap(pass.v, at, depth);
    bool inside = u >= 1.0 && v >= 1.0 && u < float(pass.map.x - 1) && v < float(pass.map.y - 1);
    if (!inside) return 1.0;
    int column = int(u), row = int(v);
    precise float right = (u - float(column)) * 0.5;
    precise float below = (v - float(row)) * 0.5;
    precise float left = 0.5 - right;
    precise float over = 0.5 - below;
    precise float limit = inMap(pass.depth, at, depth) - pass.strength.y;
    int place = row * pass.map.x + column;
    float above = litOfRow(place - pass.map.x, limit, left, right);
    float middle = litOfRow(place, limit, left, right);
    float under = litOfRow(place + pass.map.x, limit, left, right);
    precise float seen = over * above + 0.5 * middle + below * under;
    return seen;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    float depth = depths[pixel];
    if (depth > background) {
        sunlight[pixel] = 1.0;
        return;
    }
    float seen = seenOfSun(vec2(pass.size.zw + at), depth);
    precise float sun = 1.0 - pass.strength.x * (1.0 - seen);
    sunlight[pixel] = sun;
    if (pass.strength.z <= 0.0) return;
    precise float shade = 1.0 - pass.strength.z * (1.0 - sun);
    uint before = colors[pixel];
    uint after = before & 0xff000000u;
    for (int shift = 0; shift < 24; shift += 8) {
        precise float channel = float((before >> shift) & 255u) * shade + 0.5;
        after |= uint(channel) << shift;
    }
    colors[pixel] = after;
}
