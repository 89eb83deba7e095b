// What a sum has to know of what is visible, packed in a key's payload (constants.inl). docs/spec/passes.md section 2.2.

FORMULA WHOLE toleranceCode(REAL px) {
    REAL kept = LARGER(SMALLER(px, ALL(largestTolerance)), ALL(leastTolerance));
    return (BITS(kept) - toleranceBase) >> toleranceShift;
}

// px that the surface reaches behind what is visible.
FORMULA REAL toleranceOf(WHOLE visible) {
    return REAL_OF_BITS(((visible >> (24 - toleranceShift)) & (255 << toleranceShift)) + toleranceBase);
}

// The same by what is visible and by the splat.
FORMULA REAL bothReach(WHOLE visible, REAL tolerance) {
    return SMALLER(toleranceOf(visible), tolerance);
}

// The same by their normals, too, whose `cosine` is times normalStepsOfSurface squared, for a splat of half that size.
FORMULA REAL reachBehind(WHOLE visible, WHOLE cosine, REAL tolerance, REAL halfPx) {
    PRECISE REAL share = TO_REAL(cosine) * agreementPerStep + 0.5f;
    PRECISE REAL agreed = bothReach(visible, tolerance) * LARGER(SMALLER(share, ALL(1.0f)), ALL(leastAgreement));
    // What is seen edge-on stands out of its surface by its own size.
    REAL z = TO_REAL((visible << 8) >> 24);
    PRECISE REAL edgeOn = 2.0f - (z < 0.0f ? -z : z) * edgePerStep;
    PRECISE REAL itself = halfPx * SMALLER(edgeOn, ALL(1.0f));
    return LARGER(agreed, itself);
}

// Four signed bits of a length in half sizes. Of the way from a pixel to the centre of the disc that it shows they stand above the bits
// of the disc's normal: to the right first, then upwards.
FORMULA WHOLE offsetBits(REAL steps) {
    REAL bounded = SMALLER(LARGER(steps, ALL(-offsetSteps)), ALL(offsetSteps));
    PRECISE REAL above = bounded + 8.5f;
    return (TO_WHOLE(above) - 8) & 15;
}
