// Two-sided Blinn-Phong by the plane of normals (docs/spec/shading.md section 2), in place, as the cpu device computes it
// (kernels/shade.hpp). Pixels without a normal stay.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "formulas.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { PhongParams pass; };
layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 2) readonly buffer Normals { uint normals[]; };

#if SHADOWS
layout(std430, binding = 5) readonly buffer SunSeen { float sunSeen[]; };
#endif

#include "normal_plane.glsl"
#include "light.inl"

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
    vec3 n = unpackNormal(code), v = toEye(at);
    float diffuse, shine;
    blinnPhong(n.x, n.y, n.z, v.x, v.y, v.z, pass.sun.x, pass.sun.y, pass.sun.z, pass.shares.x, pass.shares.y, pass.shares.z,
               pass.shares.w, seen, diffuse, shine);
    colors[pixel] = uint(lit(int(colors[pixel]), diffuse, shine));
}
