// How normals turn across a sample, as kernels/bends.hpp has it. Needs `pass.rotation`, exact.glsl, curvatures.glsl,
// splat_tables.glsl, sample_normals.glsl and RunParams.

// Of a unit normal in cloud space, one unit long: Frisvad's frame, turned by one of 32 angles.
vec3 axisAt(vec3 n, uint angle) {
    float cosine = uintBitsToFloat(tables[axisWords + angle]), sine = uintBitsToFloat(tables[axisWords + 32u + angle]);
    precise float across = n.x * n.x + n.y * n.y;
    bool down = n.z < 0.0, pole = down && across == 0.0;
    precise float above = down ? 1.0 - n.z : 1.0;
    precise float below = down ? across : 1.0 + n.z;
    float a = quotient(above, pole ? 1.0 : below);
    precise float b = -n.x * n.y * a;
    precise float firstX = pole ? 0.0 : 1.0 - n.x * n.x * a, secondY = pole ? 0.0 : 1.0 - n.y * n.y * a;
    float firstY = pole ? -1.0 : b, secondX = pole ? -1.0 : b;
    precise float x = firstX * cosine + secondX * sine;
    precise float y = firstY * cosine + secondY * sine;
    precise float z = -(n.x * cosine + n.y * sine);
    return vec3(x, y, pole ? 0.0 : z);
}

// Principal directions in view space, and the curvatures along them, 1 / cloud units.
struct Bend {
    vec3 e1, e2;
    float k1, k2;
};

// Of a unit normal in cloud space, and the same in view space.
Bend bendOf(RunParams run, vec3 cloud, vec3 n, uint code) {
    precise float unit = run.factors.z * run.factors.w;
    float perUnit = quotient(1.0, unit);
    precise float k1 = uintBitsToFloat(tables[curvatureWords + (code & 255u)]) * perUnit;
    precise float k2 = uintBitsToFloat(tables[curvatureWords + ((code >> 8) & 255u)]) * perUnit;
    vec3 e1 = toView(axisAt(cloud, (code >> 16) & 31u));
    precise float x = n.y * e1.z - n.z * e1.y;
    precise float y = n.z * e1.x - n.x * e1.z;
    precise float z = n.x * e1.y - n.y * e1.x;
    return Bend(e1, vec3(x, y, z), k1, k2);
}
