// Circles, blended: the sum pass of hqs (docs/spec/sprites.md section 6), as kernels/sprites/sums.hpp adds them.
struct Footprint {
    ivec4 box;  // first and last pixel
    ivec2 centre;
    float x, y, half2, inverse;
    float farthest;  // depth that nothing visible may lie in front of: d <= d_vis + 2R
    ivec3 normal;    // in steps, as the visible's are
    bool anySide;    // it may be turned
    Addends addends;
};

#if SUM_TILE > 0
// About how far its footprint reaches from its centre, px.
float roughHalf(RunParams run, Placed placed) { return placed.halfPx; }
#endif

bool setUp(RunParams run, uvec4 words, Placed placed, uint color, out Footprint f) {
    float h = placed.halfPx;
    f.x = placed.x;
    f.y = placed.y;
    f.centre = ivec2(floor(vec2(f.x, f.y)));
    precise vec2 low = ceil((vec2(f.x, f.y) - h) - 0.5);
    precise vec2 high = floor((vec2(f.x, f.y) + h) - 0.5);
    f.box = ivec4(min(ivec2(low), f.centre), max(ivec2(high), f.centre));
    precise float half2 = h * h;
    f.half2 = half2;
    f.inverse = quotient(1.0, half2);
#if PERSPECTIVE
    precise float radius = (h * pass.size.z) * placed.depth;
#else
    precise float radius = h * pass.size.z;
#endif
    precise float farthest = placed.depth - 2.0 * radius;
    f.farthest = farthest;
#if SUM_NORMALS
    vec3 n = viewNormal(run, words, placed);
    f.normal = normalSteps3(n);
    f.anySide = !isOneSided(run, words);
    f.addends = addendsOf(color, n);
#else
    f.addends = addendsOf(color, vec3(0.0));
#endif
    return true;
}

void drawFragment(Footprint f, ivec2 at, uint pixel) {
    uint visible = visibleOrder(pixel);
    if (visible >= infiniteOrder || !(f.farthest <= uintBitsToFloat(visible))) return;
    precise float dx = (float(at.x) + 0.5) - f.x;
    precise float dy = (float(at.y) + 0.5) - f.y;
    precise float s = dx * dx + dy * dy;
    if (!(s <= f.half2) && at != f.centre) return;
    precise float rest = 1.0 - s * f.inverse;
    float bounded = max(rest, 0.0);
    precise float weight = bounded * root(bounded);
#if SUM_NORMALS
    bool turned = f.anySide && cosineOf(surfaceThere(pixel), f.normal) < 0;
#else
    const bool turned = false;
#endif
    addFragment(at, pixel, weight, f.addends, turned);
}
