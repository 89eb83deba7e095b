// What a sum has to know of what is visible, in the 32 bits of a key's payload (host/splat_numbers.hpp), as
// kernels/surfaces.hpp packs and asks it. Variants: SHAPE, REDUCTION, PAYLOAD, SUM_NORMALS.
#if PAYLOAD == PAYLOAD_SURFACE || REDUCTION != REDUCTION_NEAREST
const float normalStepsOfSurface = 127.0;
const uint toleranceBase = uint(127 - 8) << 23;
const int toleranceShift = 20;
const float leastTolerancePx = 0.00390625;
const float leastAgreement = 0.125, agreementPerStep = 0.000124000246, edgePerStep = 0.0314960629;
const float hiddenShare = 0.03125;
const int sameSide = 8065;
const float blendPerStep = 0.000124000246;

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

uint toleranceCode(float px) {
    float kept = max(min(px, 4194304.0), leastTolerancePx);
    return (floatBitsToUint(kept) - toleranceBase) >> toleranceShift;
}

// px that the surface reaches behind what is visible.
float toleranceOf(uint visible) { return uintBitsToFloat((visible >> 24 << toleranceShift) + toleranceBase); }

// Times normalStepsOfSurface squared.
int cosineOf(uint visible, ivec3 own) {
    ivec3 n = ivec3(int(visible << 24), int(visible << 16), int(visible << 8)) >> 24;
    return n.x * own.x + n.y * own.y + n.z * own.z;
}

// px behind what is visible that are of its surface, for a splat of half that size.
float reachBehind(uint visible, int cosine, float tolerance, float halfSize) {
    float both = min(toleranceOf(visible), tolerance);
    precise float share = float(cosine) * agreementPerStep + 0.5;
    precise float agreed = both * max(min(share, 1.0), leastAgreement);
    // What is seen edge-on stands out of its surface by its own size.
    float z = float(int(visible << 8) >> 24);
    precise float edgeOn = 2.0 - abs(z) * edgePerStep;
    precise float itself = halfSize * min(edgeOn, 1.0);
    return max(agreed, itself);
}
#endif

// In view space, of a sprite: turned to the eye where it is not oriented, and where it faces away by 30 degrees or more, so
// that a back is seen; mirrored where it faces away by less, as kernels/view_normals.hpp explains.
vec3 viewNormal(RunParams run, uvec4 words, Placed placed) {
    const float farAway = 0.25;
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
