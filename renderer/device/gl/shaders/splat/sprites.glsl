// Sprites, nearest: from a placed sample to the fragments of its key (docs/spec/sprites.md section 3), as kernels/sprites/nearest.hpp draws
// them. Variants: SHAPE, SINGLE_PIXEL.
struct Footprint {
    ivec4 box;  // first and last pixel
    ivec2 centre;
    float x, y, depth, halfPx;
    float rise;      // how fast the order grows; its unit is the profile's
    float distance;  // 8 bits of distance = this times squared px
    uint payload;    // colour, ordinal or surface
};

// The order's growth: gain * R in units of (px/h)^2, px/h or 1.
float riseOf(float depth, float h) {
#if PERSPECTIVE
    precise float radius = (h * pass.size.z) * depth;
#else
    precise float radius = h * pass.size.z;
#endif
    precise float borderDepth = pass.size.w * radius;
#if SHAPE == SHAPE_SPHERE_CIRCLE
    return borderDepth;
#elif SHAPE == SHAPE_CONE_SQUARE || SHAPE == SHAPE_CONE_CIRCLE
    return quotient(borderDepth, h);
#else
    precise float h2 = h * h;
    return quotient(borderDepth, h2);
#endif
}

float orderOf(float depth, float rise, float distance2, float h) {
    precise float order = depth;
#if SHAPE == SHAPE_SPHERE_CIRCLE
    precise float h2 = h * h;
    precise float rest = 1.0 - quotient(distance2, h2);
    order = depth + rise * (1.0 - root(max(rest, 0.0)));
#elif SHAPE == SHAPE_CONE_SQUARE || SHAPE == SHAPE_CONE_CIRCLE
    order = depth + rise * root(distance2);
#elif SHAPE == SHAPE_PARABOLOID_SQUARE || SHAPE == SHAPE_PARABOLOID_CIRCLE
    order = depth + rise * distance2;
#endif
    return order;
}

bool covers(float dx, float dy, float distance2, float h) {
#if SHAPE == SHAPE_FLAT_SQUARE || SHAPE == SHAPE_PARABOLOID_SQUARE || SHAPE == SHAPE_CONE_SQUARE
    return dx > -h && dx <= h && dy > -h && dy <= h;
#else
    precise float h2 = h * h;
    return distance2 <= h2;
#endif
}

bool setUp(RunParams run, uvec4 words, Placed placed, uint payload, out Footprint f) {
    f.x = placed.x;
    f.y = placed.y;
    f.depth = placed.depth;
    f.halfPx = placed.halfPx;
#if PAYLOAD == PAYLOAD_SURFACE
    f.payload = surfaceOf(viewNormal(run, words, placed));
#else
    f.payload = payload;
#endif
    f.centre = ivec2(floor(vec2(f.x, f.y)));
#if SINGLE_PIXEL
    f.box = ivec4(f.centre, f.centre);
#else
    float h = f.halfPx;
    f.rise = riseOf(f.depth, h);
    float atLeastHalf = max(h, 0.5);
    precise float atLeastHalf2 = atLeastHalf * atLeastHalf;
    f.distance = quotient(127.5, atLeastHalf2);
    precise vec2 low = (vec2(f.x, f.y) - h) - 0.5;
#if SHAPE == SHAPE_FLAT_SQUARE || SHAPE == SHAPE_PARABOLOID_SQUARE || SHAPE == SHAPE_CONE_SQUARE
    // What lies exactly on a square's lower border is not covered, as this finds it, however covers() rounds.
    low = floor(low) + 1.0;
#else
    low = ceil(low);
#endif
    precise vec2 high = floor((vec2(f.x, f.y) + h) + 0.5);
    f.box = ivec4(min(ivec2(low), f.centre), max(ivec2(high), f.centre));
#endif
    return true;
}

void drawFragment(Footprint f, ivec2 at, uint pixel) {
    precise float dx = (float(at.x) + 0.5) - f.x;
    precise float dy = (float(at.y) + 0.5) - f.y;
    precise float distance2 = dx * dx + dy * dy;
#if SINGLE_PIXEL
    keep(pixel, f.depth, payloadOf(distance2, 510.0, f.payload));
#else
    // The pixel of the centre is covered whatever the footprint, at the centre's depth.
    bool isCentre = at == f.centre;
    if (!isCentre && !covers(dx, dy, distance2, f.halfPx)) return;
    float order = isCentre ? f.depth : orderOf(f.depth, f.rise, distance2, f.halfPx);
    keep(pixel, order, payloadOf(distance2, f.distance, f.payload));
#endif
}
