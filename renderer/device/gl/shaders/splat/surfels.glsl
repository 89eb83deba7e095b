// Surfels: from a placed sample and its four bytes to the few numbers that every fragment is two linear functions of, as
// kernels/surfel_block.hpp derives them; the frame is explained there: x right, y down, z away from the eye.
// Variants: SHAPE, REDUCTION, PERSPECTIVE, CURVED.
struct Footprint {
    ivec4 box;  // first and last pixel
    ivec2 centre;
    float x, y, depth;
    vec2 s, t;        // place on the surfel: s = dot(s, (dx, dy)), t likewise; Ellipse: t.x = 0, units of sqrt(6) sigma
    vec2 slope;       // Disc: c = 1 + slope.x * t, or depth = d + slope.x * t without perspective; Ellipse: by (dx, dy)
    float low, high;  // Ellipse: bounds of that
    float radius;     // Disc: cloud units covered; Ellipse: half of the larger axis, px
    float tolerance;  // Disc: cloud units along the ray; Ellipse: px
    float sheet;      // Disc: the same of what faces the same way
    float halfPx;     // Disc: drawn radius, px
    float peak;       // Ellipse: weight at the centre
    float distance;   // 8 bits of distance = this times squared px
    uint payload;     // colour, ordinal or surface
#if REDUCTION != REDUCTION_NEAREST
    ivec3 normal;     // in steps, as the visible's are
    bool anySide;     // it may be turned
#endif
#if REDUCTION == REDUCTION_SUM
    Addends addends;
#elif REDUCTION == REDUCTION_CELL
    vec3 facing;      // the normal itself, in view space
#endif
#if CURVED
    bool bent;              // its normal turns, per px to the right and down; Ellipse alone
    vec3 own, right, down;  // view space
#endif
};

// A surfel, seen.
struct Pose {
    vec3 cloud;        // the normal before it is turned into view space
    vec3 n;            // unit normal
    float u, v, m;     // the ray through the centre is (u, v, 1) * depth; m = dot(n, (u, v, 1))
    float slant;       // length of the normal's part across the view axis
    vec2 across;       // its direction
    float halfPx;      // drawn radius as if facing the viewer, px
    float unitsPerPx;  // 1/q
    bool hasNormal;
    bool oneSided;     // its sign means something
};

// Outline: middle, px from the centre, and the matrix V of its second moments (halfX^2 = v.x).
struct Outline {
    vec2 middle;
    vec3 v;  // xx, xy, yy
};

// Of its border in rows: see surfel_block.hpp.
struct Rows {
    float inverseY, skew, narrow;
};

const float leastHalf = 1e-3, leastCosine = 1e-4;

uint radiusCode(uvec4 words) { return (words.w >> 16) & 255u; }

// By the side that faces the eye.
bool facesRight(Pose p) {
    if (pass.flags.y == 0) return true;
    bool faces = !p.oneSided || p.m <= 0.0 || !p.hasNormal;
    return pass.flags.y > 0 ? faces : !faces;
}

// px of a radius in cloud units, within what may be drawn.
float halfPixels(float radius, float depth) {
    precise float px = radius * pass.surfel.x;
#if PERSPECTIVE
    float seen = quotient(px, depth);
#else
    float seen = px;
#endif
    return max(min(seen, pass.surfel.w), leastHalf);
}

#if REDUCTION == REDUCTION_SUM && SUM_TILE > 0
// About how far its footprint reaches from its centre, px, however it is turned.
float roughHalf(RunParams run, Placed placed) {
    float radius = run.factors.w * pass.surfel.z * placed.ratio;
#if SHAPE == SHAPE_DISC
    return halfPixels(radius * pass.extent.x, placed.depth);
#else
    return halfPixels(radius * pass.blur.z, placed.depth) + pass.blur.y;
#endif
}
#endif

// False: it is not drawn. `radiusFactor`: what is drawn, in the sample's radii.
bool poseOf(RunParams run, uvec4 words, Placed placed, float radiusFactor, out Pose p) {
    p.cloud = sampleNormal(words.w & 0xffffu);
    p.hasNormal = any(notEqual(p.cloud, vec3(0.0)));
    p.oneSided = isOneSided(run, words);
    vec3 n = toView(p.cloud);
    // Without a normal: facing the screen.
    p.n = vec3(n.x, -n.y, p.hasNormal ? -n.z : -1.0);
#if PERSPECTIVE
    precise float u = (placed.x - pass.view.x) * pass.surfel.y;
    precise float v = (placed.y - pass.view.y) * pass.surfel.y;
    precise float unitsPerPx = placed.depth * pass.surfel.y;
#else
    float u = 0.0, v = 0.0, unitsPerPx = pass.surfel.y;
#endif
    precise float m = p.n.x * u + p.n.y * v + p.n.z;
    p.u = u;
    p.v = v;
    p.m = m;
    p.unitsPerPx = unitsPerPx;
    if (!facesRight(p)) return false;
    p.m = m < 0.0 ? min(m, -leastCosine) : max(m, leastCosine);
    precise float slant2 = p.n.x * p.n.x + p.n.y * p.n.y;
    float slant = root(slant2);
    bool facing = slant < 1e-6;
    float inverse = quotient(1.0, facing ? 1.0 : slant);
    precise vec2 across = p.n.xy * inverse;
    p.slant = slant;
    p.across = facing ? vec2(1.0, 0.0) : across;
    precise float radius = ((run.factors.w * pass.surfel.z) * placed.ratio) * radiusFactor;
    p.halfPx = halfPixels(radius, placed.depth);
    return true;
}

// Sets the box: pixels whose centres lie inside, and the one that holds the surfel's centre.
void setOutline(Outline o, inout Footprint f, out Rows rows) {
    vec2 halfSize = vec2(root(max(o.v.x, 0.0)), root(max(o.v.z, leastHalf * leastHalf)));
    float inverseY = quotient(1.0, halfSize.y);
    precise float skew = (o.v.y * inverseY) * inverseY;
    precise float rest = o.v.x - o.v.y * skew;
    precise vec2 first = 0.5 - (vec2(f.x, f.y) + (o.middle - halfSize));
    precise vec2 last = (vec2(f.x, f.y) + (o.middle + halfSize)) - 0.5;
    const float most = 4194304.0;
    vec2 centre = floor(vec2(f.x, f.y));
    f.centre = ivec2(centre);
    f.box = ivec4(ivec2(min(-floor(clamp(first, -most, most)), centre)),
                  ivec2(max(floor(clamp(last, -most, most)), centre)));
    rows.inverseY = inverseY;
    rows.skew = skew;
    rows.narrow = root(max(rest, 0.0));
}

// `above`: bits over its normal's.
void setCommon(Placed placed, Pose p, uint payload, uint above, inout Footprint f) {
    f.payload = payload;
    float atLeastHalf = max(p.halfPx, 0.5);
    precise float atLeastHalf2 = atLeastHalf * atLeastHalf;
    f.distance = quotient(127.5, atLeastHalf2);
    // Turned to the eye unless a side is known; in view space y is up and z towards the viewer.
    vec3 n = vec3(p.n.x, -p.n.y, -p.n.z);
    vec3 turned = !p.oneSided && p.m > 0.0 ? -n : n;
#if SHAPE == SHAPE_DISC
    // Discs meet as the eye sees them, from whichever side.
    vec3 seen = p.m > 0.0 ? -n : n;
#else
    vec3 seen = turned;
#endif
#if PAYLOAD == PAYLOAD_SURFACE
    f.payload = surfaceOf(seen) | above;
#endif
#if REDUCTION != REDUCTION_NEAREST
    f.normal = normalSteps3(seen);
    f.anySide = !p.oneSided;
#endif
#if REDUCTION == REDUCTION_CELL
    f.facing = seen;
#elif REDUCTION == REDUCTION_SUM
    f.addends = addendsOf(payload, p.hasNormal ? turned : vec3(0.0));
#endif
}

#if SHAPE == SHAPE_DISC
// From the disc's dual conic: with e = (half/f)^2 and S the projector onto its plane seen in the frame of the ray, the
// middle lies at -e * f * S.z / (1 - e * S.zz).
Outline outlineOf(Pose p, float halfPx) {
    precise float x = p.n.x - p.u * p.n.z, y = p.n.y - p.v * p.n.z;
    precise float xx = 1.0 + p.u * p.u - x * x, yy = 1.0 + p.v * p.v - y * y, xy = p.u * p.v - x * y;
    precise float h2 = halfPx * halfPx;
#if PERSPECTIVE
    float pixel = pass.surfel.y;
    precise float e = h2 * (pixel * pixel);
    precise float shrunk = 1.0 - e * (1.0 - p.n.z * p.n.z);
    float grown = quotient(h2, shrunk);
    precise float middleX = (grown * pixel) * (p.u + x * p.n.z);
    precise float middleY = (grown * pixel) * (p.v + y * p.n.z);
    precise float vxx = middleX * middleX + grown * max(xx, 0.0);
    precise float vxy = middleX * middleY + grown * xy;
    precise float vyy = middleY * middleY + grown * max(yy, 0.0);
    return Outline(vec2(middleX, middleY), vec3(vxx, vxy, vyy));
#else
    precise vec3 v = h2 * vec3(xx, xy, yy);
    return Outline(vec2(0.0), v);
#endif
}

bool setUp(RunParams run, uvec4 words, Placed placed, uint payload, out Footprint f) {
    Pose p;
    if (!poseOf(run, words, placed, 1.0, p)) return false;
    f.x = placed.x;
    f.y = placed.y;
    f.depth = placed.depth;
    float halfPx = p.halfPx;
#if REDUCTION == REDUCTION_SUM
    precise float reached = halfPx * pass.extent.x;
    halfPx = reached;
#if PERSPECTIVE
    halfPx = min(reached, pass.extent.y);
#endif
#endif
    precise float towards = halfPx * p.m;
    float inverse = quotient(1.0, towards);
    precise float sx = (p.v * p.slant + p.across.y * p.n.z) * inverse;
    precise float sy = -((p.u * p.slant + p.across.x * p.n.z) * inverse);
    precise vec2 t = p.across * inverse;
    f.s = vec2(sx, sy);
    f.t = t;
    precise float radius = halfPx * p.unitsPerPx;
    precise float slope = p.slant * halfPx;
#if PERSPECTIVE
    precise float along = slope * pass.surfel.y;
#else
    precise float along = -(slope * p.unitsPerPx);
#endif
    // Of another direction, across the surface: along the ray it is more.
    precise float sheet = pass.extent.z * (p.halfPx * p.unitsPerPx);
    float tolerance = quotient(sheet, clamp(abs(p.m), leastCosineOfGap, 1.0));
    f.sheet = sheet;
    f.slope = vec2(along, 0.0);
    f.radius = radius;
    f.tolerance = tolerance;
    Rows rows;
    setOutline(outlineOf(p, halfPx), f, rows);
    f.halfPx = p.halfPx;
    setCommon(placed, p, payload, 0u, f);
    return true;
}
#else
#if CURVED
// As kernels/surfel_block.hpp has it; `bendCode` is the sample's.
void setBend(RunParams run, Pose p, inout Footprint f) {
    f.bent = false;
    if (bendCode == 0u || !p.hasNormal) return;
    vec3 n = vec3(p.n.x, -p.n.y, -p.n.z);
    Bend b = bendOf(run, p.cloud, n, bendCode);
    float turn = !p.oneSided && p.m > 0.0 ? -1.0 : 1.0;
    precise float per = (f.peak * p.unitsPerPx) * turn;
    float overM = quotient(1.0, p.m);
    precise float along1 = ((b.e1.x * p.u - b.e1.y * p.v) - b.e1.z) * overM;
    precise float along2 = ((b.e2.x * p.u - b.e2.y * p.v) - b.e2.z) * overM;
    precise float k1 = b.k1 * per, k2 = b.k2 * per;
    precise float right1 = k1 * (b.e1.x - along1 * p.n.x), right2 = k2 * (b.e2.x - along2 * p.n.x);
    precise float down1 = k1 * (-b.e1.y - along1 * p.n.y), down2 = k2 * (-b.e2.y - along2 * p.n.y);
    precise vec3 right = right1 * b.e1 + right2 * b.e2;
    precise vec3 down = down1 * b.e1 + down2 * b.e2;
    f.own = turn * n;
    f.right = right;
    f.down = down;
    f.bent = b.k1 != 0.0 || b.k2 != 0.0;
}
#endif

// Half-axes in px, in the picture: what a step along the axis moves there.
struct Axes {
    vec3 a, b;
};

void setAxes(Pose p, uint code, out Axes axes) {
    vec3 view = toView(axisOf(p.cloud, code & 31u));
    vec3 d = p.hasNormal ? vec3(view.x, -view.y, -view.z) : vec3(1.0, 0.0, 0.0);
    precise float minor = p.halfPx * ratioOf(int(code), pass.blur.w);
    precise vec3 a = p.halfPx * d;
    precise float bx = minor * (p.n.y * d.z - p.n.z * d.y);
    precise float by = minor * (p.n.z * d.x - p.n.x * d.z);
    precise float bz = minor * (p.n.x * d.y - p.n.y * d.x);
    axes.a = a;
    axes.b = vec3(bx, by, bz);
}

// How far a fragment may lie behind its centre, px: a surfel's own extent. None lies before it (kernels/surfel_block.hpp).
float depthRange(Axes axes) {
    precise float range2 = axes.a.z * axes.a.z + axes.b.z * axes.b.z;
    return root(range2);
}

// px behind it that are of its surface: what it covers itself, and what the low-pass takes in of its plane.
float ellipseTolerance(Pose p, float range) {
    float steep = abs(p.n.z);
    precise float limit = 8.0 * steep;
    float open = quotient(p.slant, max(steep, 0.1));
    precise float blur = pass.blur.y * (p.slant < limit ? open : 8.0);
    precise float reach2 = range * range + blur * blur;
    precise float tolerance = 2.0 * (p.halfPx + root(reach2));
    return tolerance;
}

void setDepths(Pose p, float range, inout Footprint f) {
#if PERSPECTIVE
    precise float towards = p.m * pass.surfel.x;
    float perM = quotient(1.0, towards);
    precise float back = 1.0 + range * pass.surfel.y;
    float low = quotient(1.0, back);
    const float high = 1.0;
#else
    float perM = quotient(-p.unitsPerPx, p.m);
    float low = f.depth;
    precise float high = f.depth + range * p.unitsPerPx;
#endif
    precise vec2 slope = p.n.xy * perM;
    f.slope = slope;
    f.low = low;
    f.high = high;
    f.tolerance = ellipseTolerance(p, range);
    f.radius = p.halfPx;
}

bool setUp(RunParams run, uvec4 words, Placed placed, uint payload, out Footprint f) {
    uint radius = radiusCode(words), code = words.w >> 24;
    bool known = radius != 0u && radius != outlierCode && pass.flags.w != 0;
    Pose p;
    if (!poseOf(run, words, placed, known ? pass.blur.z : 1.0, p)) return false;
    f.x = placed.x;
    f.y = placed.y;
    f.depth = placed.depth;
    Axes axes;
    setAxes(p, code, axes);
    precise float ax = axes.a.x - p.u * axes.a.z, ay = axes.a.y - p.v * axes.a.z;
    precise float bx = axes.b.x - p.u * axes.b.z, by = axes.b.y - p.v * axes.b.z;
    precise float vxx = ax * ax + bx * bx + pass.blur.x;
    precise float vxy = ax * ay + bx * by;
    precise float vyy = ay * ay + by * by + pass.blur.x;
    Rows rows;
    setOutline(Outline(vec2(0.0), vec3(vxx, vxy, vyy)), f, rows);
    float inverse = quotient(1.0, max(rows.narrow, leastHalf));
    precise float sy = -(rows.skew * inverse);
    f.s = vec2(inverse, sy);
    f.t = vec2(0.0, rows.inverseY);
    precise float peak = (abs(ax * by - ay * bx) * inverse) * rows.inverseY;
    f.peak = min(peak, 1.0);
    setDepths(p, depthRange(axes), f);
#if PAYLOAD == PAYLOAD_SURFACE
    setCommon(placed, p, payload, uint(toleranceCode(f.tolerance)) << 24, f);
#else
    setCommon(placed, p, payload, 0u, f);
#endif
#if CURVED
    setBend(run, p, f);
#endif
    return true;
}
#endif
