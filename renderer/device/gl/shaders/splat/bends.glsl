// How normals turn across a sample, as kernels/bends.hpp has it. Needs `pass.rotation`, exact.glsl, beside.glsl,
// axes.glsl, sample_normals.glsl and RunParams.

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
    vec3 e1 = toView(axisOf(cloud, (code >> 16) & 31u));
    precise float x = n.y * e1.z - n.z * e1.y;
    precise float y = n.z * e1.x - n.x * e1.z;
    precise float z = n.x * e1.y - n.y * e1.x;
    return Bend(e1, vec3(x, y, z), k1, k2);
}
