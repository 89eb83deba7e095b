// Two-sided Blinn-Phong by the plane of normals (docs/spec/shading.md section 2), in place, as the cpu device computes it
// (kernels/shade.hpp). Pixels without a normal stay.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PhongParams pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 2) readonly buffer Normals { uint normals[]; };

#include "normal_plane.glsl"

// To the directional light, view space: upper left, behind the viewer.
const float light = 0.57735027;

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

// Factor of the colour, and what is added to it.
vec2 brightnessOf(vec3 n, vec3 v) {
    precise float facing = n.x * v.x + n.y * v.y + n.z * v.z;
    float side = facing < 0.0 ? -1.0 : 1.0;
    precise float lit = side * (n.x * -light + n.y * light + n.z * light);
    lit = lit > 0.0 ? lit : 0.0;
    precise float hx = v.x - light;
    precise float hy = v.y + light;
    precise float hz = v.z + light;
    precise float halfway = side * (n.x * hx + n.y * hy + n.z * hz);
    // The halfway vector is never 0: the light stands behind the viewer, v before him.
    precise float length2 = hx * hx + hy * hy + hz * hz;
    precise float shine = quotient(halfway > 0.0 ? halfway : 0.0, root(length2));
    for (int doubled = 0; doubled < 5; ++doubled) shine = shine * shine;
    precise float diffuse = pass.shares.x + pass.shares.y * (side * facing) + pass.shares.z * lit;
    precise float specular = (pass.shares.w * 255.0) * shine;
    return vec2(diffuse, specular);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    uint code = normals[pixel];
    if (code == 0u) return;
    vec2 b = brightnessOf(unpackNormal(code), toEye(at));
    uint before = colors[pixel];
    uint after = before & 0xff000000u;
    for (int shift = 0; shift < 24; shift += 8) {
        precise float value = float((before >> shift) & 255u) * b.x + b.y + 0.5;
        after |= uint(int(value < 255.0 ? value : 255.0)) << shift;
    }
    colors[pixel] = after;
}
