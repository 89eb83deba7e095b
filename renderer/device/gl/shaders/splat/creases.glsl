// Where discs meet at an angle: which of two is the surface, and which only hangs over it, as kernels/creases.hpp decides; the
// frame is explained there: x right, y up, z towards the viewer. Variants: REDUCTION, PAYLOAD, SHAPE, PERSPECTIVE.
#if SHAPE == SHAPE_DISC && REDUCTION != REDUCTION_SUM
// From a pixel to the centre of the disc that it shows, above the bits of the disc's normal; px to the right and up.
uint withOffset(uint normal, vec2 offset, float halfPx) {
    float stepsPerPx = quotient(offsetSteps, halfPx);
    precise vec2 steps = offset * stepsPerPx;
    return normal | uint(offsetBits(steps.x)) << 24 | uint(offsetBits(steps.y)) << 28;
}

// What becomes of a disc that lies behind a visible one of another direction.
const int crossingDiscs = 0;  // nobody knows: the nearer centre wins
const int discWins = 1;       // the surface is its: the visible one hangs over a convex crease
const int discShunned = 2;    // it is not: it goes on behind a concave one

// `disc`: its normal; `offset`: px to its centre, right and up; `gap`: px along the ray (uv, -1) from the visible one to the
// disc.
int meet(uint visible, vec3 disc, vec2 offset, float halfPx, float gap, vec2 uv) {
    precise vec3 n = vec3(ivec3(int(visible << 24), int(visible << 16), int(visible << 8)) >> 24) * stepPerNormal;
    precise float pxPerStep = halfPx * halfPerStep;
    precise vec2 there = vec2(ivec2(int(visible << 4), int(visible)) >> 28) * pxPerStep;
    precise float nRay = (n.x * uv.x + n.y * uv.y) - n.z, discRay = (disc.x * uv.x + disc.y * uv.y) - disc.z;
    float n0 = min(nRay, -leastOpen), d0 = min(discRay, -leastOpen);
    precise float nAcross = n.x * there.x + n.y * there.y, discAcross = disc.x * offset.x + disc.y * offset.y;
    float along = quotient(nAcross, n0), back = quotient(discAcross, d0);
    // The visible one's centre over the disc's plane, and the disc's centre over that of the visible one.
    precise float above = (disc.x * there.x + disc.y * there.y) - (along + gap) * d0;
    precise float itself = (n.x * offset.x + n.y * offset.y) + (gap - back) * n0;
    precise float both = above + itself;
    float limit = creaseSlack * halfPx;
    if (above <= limit && itself <= limit && both < 0.0) return discWins;
    return above < -limit && itself > limit ? crossingDiscs : discShunned;
}
#endif
