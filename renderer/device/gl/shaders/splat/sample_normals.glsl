// Normals of samples, out of their 8 + 8 bits and into view space, as kernels/normal_plane.hpp and view_normals.hpp do.
// Needs `pass.rotation` and exact.glsl.

// Cloud space, of any length: the direction is exact. (0, 0, 0) where there is none.
vec3 sampleDirection(uint code) {
    if ((code & 0xffffu) == 0u) return vec3(0.0);
    float u = float(int((code >> 8) & 255u) - 128), v = float(int(code & 255u) - 128);
    float z = 127.0 - abs(u) - abs(v);
    if (z >= 0.0) return vec3(u, v, z);
    float x = 127.0 - abs(v), y = 127.0 - abs(u);
    return vec3(u < 0.0 ? -x : x, v < 0.0 ? -y : y, z);
}

// One unit long.
vec3 sampleNormal(uint code) {
    vec3 n = sampleDirection(code);
    precise float length2 = n.x * n.x + n.y * n.y + n.z * n.z;
    float inverse = quotient(1.0, root(length2 > 0.0 ? length2 : 1.0));
    precise vec3 unit = n * inverse;
    return unit;
}

// x right, y up, z towards the viewer.
vec3 toView(vec3 n) {
    vec3 a = pass.rotation[0].xyz, b = pass.rotation[1].xyz, c = pass.rotation[2].xyz;
    precise float x = a.x * n.x + (a.y * n.y + a.z * n.z);
    precise float y = b.x * n.x + (b.y * n.y + b.z * n.z);
    precise float z = c.x * n.x + (c.y * n.y + c.z * n.z);
    return vec3(x, y, z);
}
