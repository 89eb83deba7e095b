// Directions in a surface, by their codes. Needs exact.glsl, formulas.glsl, ellipses.inl and splat_tables.glsl.

// One of 32, of a unit normal in cloud space.
vec3 axisOf(vec3 n, uint angle) {
    float cosine = uintBitsToFloat(tables[axisWords + angle]), sine = uintBitsToFloat(tables[axisWords + 32u + angle]);
    vec3 axis;
    axisAt(n.x, n.y, n.z, cosine, sine, axis.x, axis.y, axis.z);
    return axis;
}
