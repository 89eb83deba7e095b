// What a sum has to know of what is visible, in the 32 bits of a key's payload (formulas/constants.inl), as
// kernels/surfaces.hpp packs and asks it. Variants: SHAPE, REDUCTION, PAYLOAD, SUM_NORMALS.
#if PAYLOAD == PAYLOAD_SURFACE || REDUCTION != REDUCTION_NEAREST
// Bytes as integers of their own: each part in [-1, 1].
ivec3 normalSteps3(vec3 n) {
    vec3 halves = vec3(n.x < 0.0 ? -0.5 : 0.5, n.y < 0.0 ? -0.5 : 0.5, n.z < 0.0 ? -0.5 : 0.5);
    precise vec3 rounded = n * normalStepsOfSurface + halves;
    return ivec3(rounded);
}

uint surfaceOf(vec3 n) {
    uvec3 bytes = uvec3(normalSteps3(n)) & 255u;
    return bytes.x | bytes.y << 8 | bytes.z << 16;
}

// Times normalStepsOfSurface squared.
int cosineOf(uint visible, ivec3 own) {
    ivec3 n = ivec3(int(visible << 24), int(visible << 16), int(visible << 8)) >> 24;
    return n.x * own.x + n.y * own.y + n.z * own.z;
}
#endif

// In view space, of a sprite: turned to the eye where it is not oriented, and where it faces away by 30 degrees or more, so
// that a back is seen; mirrored where it faces away by less, as kernels/view_normals.hpp explains.
vec3 viewNormal(RunParams run, uvec4 words, Placed placed) {
    vec3 n = toView(sampleNormal(words.w & 0xffffu));
    bool anySide = !isOneSided(run, words);
#if PERSPECTIVE
    precise float px = (placed.x - pass.view.x) * pass.surfel.y;
    precise float py = (pass.view.y - placed.y) * pass.surfel.y;
    precise float towards = n.z - (n.x * px + n.y * py);
    precise float length2 = px * px + py * py + 1.0;
#else
    float towards = n.z;
    const float length2 = 1.0;
#endif
    if (!(towards < 0.0)) return n;
    precise float squared = towards * towards, far = farAway * length2;
    if (anySide || squared >= far) return -n;
    precise float doubled = 2.0 * towards;
    float twice = quotient(doubled, length2);
#if PERSPECTIVE
    precise vec3 mirrored = vec3(n.x + twice * px, n.y + twice * py, n.z - twice);
#else
    precise vec3 mirrored = vec3(n.x, n.y, n.z - twice);
#endif
    return mirrored;
}
