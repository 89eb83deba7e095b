// Two-sided Blinn-Phong by the plane of normals (docs/spec/shading.md section 2), in place, as the cpu device computes it
// (kernels/shade.hpp). Pixels without a normal stay.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PhongParams pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 2) readonly buffer Normals { uint normals[]; };

#if SHADOWS
layout(std430, binding = 5) readonly buffer SunSeen { float sunSeen[]; };
#endif

#include "normal_plane.glsl"

// Where the headlight is, beside the way to the eye (screen_numbers.hpp).
const vec2 lamp = vec2(-0.5, 0.28867513);

// From a pixel's point to the eye, unit length.
vec3 toEye(ivec2 at) {
    if (pass.eye.z == 0.0) return vec3(0.0, 0.0, 1.0);
    precise float x = (pass.eye.x + float(pass.size.z + at.x)) * pass.eye.z;
    precise float y = -((pass.eye.y + float(pass.size.w + at.y)) * pass.eye.z);
    precise float length2 = x * x + y * y + 1.0;
    float inverse = quotient(1.0, root(length2));
    precise vec3 v = vec3(-x * inverse, -y * inverse, inverse);
    return v;
}

float positive(float value) { return value > 0.0 ? value : 0.0; }

// Factor of the colour, and how far it then goes to white.
vec2 brightnessOf(vec3 n, vec3 v, float seen) {
    precise float facing = n.x * v.x + n.y * v.y + n.z * v.z;
    float side = facing < 0.0 ? -1.0 : 1.0;
    precise vec2 toLamp = v.xy + lamp;
    precise float distance2 = toLamp.x * toLamp.x + toLamp.y * toLamp.y + v.z * v.z;
    float nearer = quotient(1.0, root(distance2));
    precise vec3 m = vec3(toLamp, v.z) * nearer;
    precise float ofLamp = side * (n.x * m.x + n.y * m.y + n.z * m.z);
    precise float ofSun = side * (n.x * pass.sun.x + n.y * pass.sun.y + n.z * pass.sun.z);
    precise float hx = v.x + m.x;
    precise float hy = v.y + m.y;
    precise float hz = v.z + m.z;
    precise float halfway = side * (n.x * hx + n.y * hy + n.z * hz);
    // Neither is ever 0: eye and lamp are before whatever is seen.
    precise float length2 = hx * hx + hy * hy + hz * hz;
    precise float shine = quotient(positive(halfway), root(length2));
    for (int doubled = 0; doubled < 6; ++doubled) shine = shine * shine;
    // Large and near: what is turned a little from it gets hardly less, what is turned away from it still some.
    precise float reached = ofLamp * 0.71428571 + 0.28571429;
    reached = positive(reached);
    precise float soft = reached * (2.0 - reached);
    precise float diffuse = pass.shares.x + pass.shares.y * soft + pass.shares.z * (positive(ofSun) * seen);
    precise float reflected = pass.shares.w * shine;
    return vec2(diffuse < 2.0 ? diffuse : 2.0, reflected);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    uint code = normals[pixel];
    if (code == 0u) return;
#if SHADOWS
    float seen = sunSeen[pixel];
#else
    float seen = 1.0;
#endif
    vec2 b = brightnessOf(unpackNormal(code), toEye(at), seen);
    // What brightens bends towards white, and nothing but white becomes so.
    float less = b.x < 1.0 ? b.x : 1.0;
    precise float more = positive(b.x - 1.0);
    uint before = colors[pixel];
    uint after = before & 0xff000000u;
    for (int shift = 0; shift < 24; shift += 8) {
        precise float dimmed = float((before >> shift) & 255u) * less;
        precise float value = dimmed + dimmed * more * (1.0 - dimmed * 0.003921569);
        precise float shining = value + b.y * (255.0 - value) + 0.5;
        after |= uint(int(shining < 255.0 ? shining : 255.0)) << shift;
    }
    colors[pixel] = after;
}
