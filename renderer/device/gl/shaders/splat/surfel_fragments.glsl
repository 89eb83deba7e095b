// One surfel's fragments, as kernels/surfel_fragments.hpp reduces them. Variants: SHAPE, REDUCTION, PERSPECTIVE, SILHOUETTE,
// CURVED.

// Below, `c` tells the depth: d / c in perspective, else the depth itself.
float depthOf(Footprint f, float c) {
#if PERSPECTIVE
    float depth = quotient(f.depth, c);
    return depth;
#else
    return c;
#endif
}

// Whether a fragment lies behind a depth.
bool behind(Footprint f, float c, float border) {
#if PERSPECTIVE
    precise float there = border * c;
    return f.depth > there;
#else
    return c > border;
#endif
}

bool inFrontOf(Footprint f, float c, float border) {
#if PERSPECTIVE
    precise float there = border * c;
    return f.depth < there;
#else
    return c < border;
#endif
}

#if REDUCTION != REDUCTION_NEAREST
#if SHAPE == SHAPE_DISC
// Whether a fragment lies so near to what is visible.
bool nearVisible(Footprint f, float c, float visible, float tolerance) {
    precise float high = visible + tolerance;
    if (behind(f, c, high)) return false;
    precise float low = visible - tolerance;
    return !inFrontOf(f, c, low);
}
#else
// Whether a fragment lies at most so many px behind what is visible.
bool within(Footprint f, float c, float visible, float px) {
    precise float units = px * pass.surfel.y;
#if PERSPECTIVE
    precise float high = visible + visible * units;
#else
    precise float high = visible + units;
#endif
    return !behind(f, c, high);
}
#endif
#endif

#if SHAPE == SHAPE_DISC
// Distance from the centre in radii; at most 1, also in the centre's pixel.
float placeOnDisc(float square, float c) {
    float place = root(square);
#if PERSPECTIVE
    place = quotient(place, c);
#endif
    return min(place, 1.0);
}
#endif

float weightOf(Footprint f, float square, float c) {
#if SHAPE == SHAPE_DISC
    float t = placeOnDisc(square, c);
    precise float weight = 1.0 - (t * t) * (3.0 - 2.0 * t);
#else
    precise float weight = f.peak * bell(smaller(square, 1.0));
#endif
    return weight;
}

#if REDUCTION == REDUCTION_CELL
// The distance to the disc's centre, or as if it were none; false: what is visible there goes on before it.
bool seeCreases(Footprint f, ivec2 at, uint pixel, vec2 d, float visible, float c, inout float order, inout uint payload) {
    uint surface = surfaceThere(pixel);
    int cosine = cosineOf(surface, f.normal);
    if ((f.anySide ? abs(cosine) : cosine) >= sameSide) return nearVisible(f, c, visible, f.sheet);
    precise float gap = (depthOf(f, c) - visible) * pass.surfel.x;
#if PERSPECTIVE
    gap = quotient(gap, visible);
    precise vec2 uv = vec2((float(at.x) + 0.5) - pass.view.x, pass.view.y - (float(at.y) + 0.5)) * pass.surfel.y;
#else
    const vec2 uv = vec2(0.0);
#endif
    int verdict = meet(surface, f.facing, vec2(-d.x, d.y), f.halfPx, gap, uv);
    precise float before = order * creasePriority;
    if (verdict == discWins) order = before;
#if PAYLOAD == PAYLOAD_SURFACE
    payload |= uint(toleranceCode(gap)) << 24;
#endif
    return verdict != discShunned;
}
#endif

// `d`: px from the centre, right and down.
void reduce(Footprint f, ivec2 at, uint pixel, vec2 d, float square, float c) {
#if REDUCTION != REDUCTION_NEAREST
    uint visibleBits = visibleOrder(pixel);
    if (visibleBits >= infiniteOrder) return;
    float visible = uintBitsToFloat(visibleBits);
#if SHAPE == SHAPE_DISC
    if (!nearVisible(f, c, visible, f.tolerance)) return;
#endif
#endif
#if REDUCTION == REDUCTION_SUM
    uint surface = surfaceThere(pixel);
    int cosine = cosineOf(surface, f.normal);
    bool turned = f.anySide && cosine < 0;
#if SHAPE == SHAPE_DISC
    // No more than the angle between their normals leaves of it.
    precise float left = float(turned ? -cosine : cosine) * blendPerStep - 0.5;
    if (!(left > 0.0)) return;
    float share = min(left, 1.0);
    precise float units = toleranceOf(int(surface)) * pass.surfel.y;
#if PERSPECTIVE
    precise float there = visible + visible * units;
#else
    precise float there = visible + units;
#endif
    if (!nearVisible(f, c, there, f.sheet)) return;
#else
    float share = 1.0;
    if (!within(f, c, visible, f.tolerance)) return;
    float reach = reachBehind(int(surface), turned ? -cosine : cosine, f.tolerance, f.radius);
    if (!within(f, c, visible, reach)) share = hiddenShare;
#endif
#endif
#if SILHOUETTE
    uint border = silhouetteOrder(pixel);
    if (border < infiniteOrder && behind(f, c, uintBitsToFloat(border))) return;
#endif
#if REDUCTION == REDUCTION_SUM
    precise float weight = weightOf(f, square, c) * share;
#if CURVED
    if (f.bent) {
        precise vec3 n = (f.own + f.right * d.x) + f.down * d.y;
        n = clamp(n, -1.0, 1.0);
        f.addends.normal = uvec3(shifted(n.x), shifted(n.y), shifted(n.z));
    }
#endif
    addFragment(at, pixel, weight, f.addends, turned);
#else
#if REDUCTION == REDUCTION_CELL
    precise float order = placeOnDisc(square, c) * f.radius;
    uint payload = f.payload;
    if (!seeCreases(f, at, pixel, d, visible, c, order, payload)) return;
#else
    precise float order = depthOf(f, c);
#if SHAPE == SHAPE_DISC && PAYLOAD == PAYLOAD_SURFACE
    uint payload = withOffset(f.payload, vec2(-d.x, d.y), f.halfPx);
#else
    precise float distance2 = d.x * d.x + d.y * d.y;
    uint payload = payloadOf(distance2, f.distance, f.payload);
#endif
#endif
    keep(pixel, max(order, 1.17549435e-38), payload);
#endif
}

void drawFragment(Footprint f, ivec2 at, uint pixel) {
#if PERSPECTIVE
    const float atCentre = 1.0;
#else
    float atCentre = f.depth;
#endif
    precise float dx = (float(at.x) + 0.5) - f.x;
    precise float dy = (float(at.y) + 0.5) - f.y;
    precise float s = f.s.x * dx + f.s.y * dy;
#if SHAPE == SHAPE_DISC
    precise float t = f.t.x * dx + f.t.y * dy;
    precise float c = f.slope.x * t + atCentre;
#else
    precise float t = f.t.y * dy;
    precise float on = (atCentre + f.slope.x * dx) + f.slope.y * dy;
    float c = min(max(on, f.low), f.high);
#endif
    precise float square = s * s + t * t;
    // The pixel of the centre is covered anyway, at the centre's depth.
    bool isCentre = at == f.centre;
#if SHAPE == SHAPE_DISC && PERSPECTIVE
    precise float limit = c * c;
#else
    const float limit = 1.0;
#endif
    if (!isCentre && !(square <= limit)) return;
    float seen = isCentre ? atCentre : c;
#if PERSPECTIVE
    precise float nearest = pass.view.z * seen;
    if (!(f.depth >= nearest)) return;
#else
    if (!(seen >= pass.view.z)) return;
#endif
    reduce(f, at, pixel, vec2(dx, dy), square, seen);
}
