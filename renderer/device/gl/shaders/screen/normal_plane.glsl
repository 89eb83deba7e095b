// The plane of normals between passes: octahedral 16 + 16 bits in view space, 0 where there is none; as the cpu
// device packs it (kernels/normal_plane.hpp). Needs exact.glsl.

float withSign(float magnitude, float sign) {
    return sign < 0.0 ? -magnitude : magnitude;
}

// Of any length; 0 where that is 0 or not a number.
uint packNormal(vec3 n) {
    precise float sum = abs(n.x) + abs(n.y) + abs(n.z);
    bool known = sum > 0.0 && sum < 3.4e38;
    float inverse = quotient(1.0, known ? sum : 1.0);
    precise float px = n.x * inverse;
    precise float py = n.y * inverse;
    precise float foldedX = 1.0 - abs(py);
    precise float foldedY = 1.0 - abs(px);
    float u = n.z < 0.0 ? withSign(foldedX, px) : px;
    float v = n.z < 0.0 ? withSign(foldedY, py) : py;
    precise float stepsU = (known ? u : 0.0) * 32767.0 + 32768.5;
    precise float stepsV = (known ? v : 0.0) * 32767.0 + 32768.5;
    return known ? uint(floor(stepsU)) << 16 | uint(floor(stepsV)) : 0u;
}

// A unit vector; (0, 0, 0) where there is none.
vec3 unpackNormal(uint code) {
    if (code == 0u) return vec3(0.0);
    precise float u = quotient(float(code >> 16) - 32768.0, 32767.0);
    precise float v = quotient(float(code & 0xffffu) - 32768.0, 32767.0);
    precise float z = 1.0 - abs(u) - abs(v);
    precise float foldedX = 1.0 - abs(v);
    precise float foldedY = 1.0 - abs(u);
    float x = z < 0.0 ? withSign(foldedX, u) : u;
    float y = z < 0.0 ? withSign(foldedY, v) : v;
    precise float length2 = x * x + y * y + z * z;
    float inverse = quotient(1.0, root(length2));
    precise vec3 unit = vec3(x, y, z) * inverse;
    return unit;
}
