// Hidden point removal: which pixels other points occlude. docs/spec/pyramid.md section 4; as the
// cpu device computes it (kernels/hidden_points.hpp), which says why each step decides as it does.
//
// A work group is one block of 16 x 16 pixels, which look at the same levels. The texels that they look at are copied
// to shared memory: (16 >> level) + 4 on a side.
#version 450 core
#include "layouts_screen.glsl"
#include "exact.glsl"
#include "pyramid.glsl"
#include "unproject.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 3) writeonly buffer Labels { uint labels[]; };
layout(std430, binding = 4) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 6) buffer Closing { int closing[]; };

const uint hiddenLabel = 0u, foregroundLabel = 1u, backgroundLabel = 2u;
// One depth of this level chooses the levels of a block.
const int blockLevel = 4;

shared vec4 rings[269 + 16 * (pyramidLevels - 5)];
shared float around[18 * 18];
// Whether some pixel of the block has a neighbour: the coarsest ring covers the finer ones.
shared bool accompanied;
// Of the block's visible points: sum of the radii of their closings, and how many there are.
shared int sizes, visible;

// Calls X(column, row, sector) for the ring of 12 in 4 x 4, and for the pixels around one. Sectors are in reading
// order: north-west, north, north-east, west, east, south-west, south, south-east.
#define RING(X) X(0, 0, 0) X(1, 0, 1) X(2, 0, 1) X(3, 0, 2) X(0, 1, 3) X(3, 1, 4) \
                X(0, 2, 3) X(3, 2, 4) X(0, 3, 5) X(1, 3, 6) X(2, 3, 6) X(3, 3, 7)
#define PIXELS(X) X(0, 0, 0) X(1, 0, 1) X(2, 0, 2) X(0, 1, 3) X(2, 1, 4) X(0, 2, 5) X(1, 2, 6) X(2, 2, 7)

// In rings[]: a level's first texel, and its texels in a row.
int firstOf(int level) {
    return level == 1 ? 0 : level == 2 ? 144 : level == 3 ? 208 : level == 4 ? 244 : 269 + 16 * (level - 5);
}
int sideOf(int level) {
    return (16 >> level) + 4;
}

// Top left texel of the ring around a pixel: floor((pixel + 0.5) / 2^level - 1.5).
ivec2 ringStart(ivec2 pixel, int level) {
    return (((pixel >> (level - 1)) - 1) >> 1) - 1;
}

// The depth of a block: that of the nearest point in it, or around it.
float depthOf(ivec2 block) {
    float depth = infinity;
    for (int k = blockLevel; k < pyramid.size.z && !(depth < infinity); ++k)
        depth = points[placeOf(k, block >> (k - blockLevel))].x;
    return depth;
}

// Up to which depth points have neighbours in a level. The component is chosen by comparison: where both indices are
// computed, NVIDIA's compiler (580.159) reads another one.
float farthestOf(int level) {
    vec4 four = pyramid.farthest[level >> 2];
    int component = level & 3;
    return component == 0 ? four.x : component == 1 ? four.y : component == 2 ? four.z : four.w;
}

// The coarsest level that a block looks at.
int reachOf(float depth) {
    int reach = 0;
    while (reach < pyramid.size.w && depth <= farthestOf(reach + 1)) ++reach;
    return reach;
}

// The radius of a closing at a depth, eighths of a pixel.
int closingAt(float depth) {
    float size = perspective() ? quotient(pyramid.closing.x, max(depth, pyramid.closing.w)) : pyramid.closing.x;
    return int(min(max(size, pyramid.closing.y), pyramid.closing.z));
}

void loadNeighbours(ivec2 corner, int reach) {
    if (gl_LocalInvocationIndex == 0u) {
        accompanied = reach < 3;
        sizes = 0;
        visible = 0;
    }
    barrier();
    int total = firstOf(reach + 1);
    for (int i = int(gl_LocalInvocationIndex); i < total; i += 256) {
        int level = i < 144 ? 1 : i < 208 ? 2 : i < 244 ? 3 : i < 269 ? 4 : 5 + ((i - 269) >> 4);
        int own = i - firstOf(level), side = sideOf(level);
        ivec2 at = ringStart(corner, level) + ivec2(own % side, own / side);
        vec4 point = inside(at, sizeOf(level)) ? points[placeOf(level, at)] : nothing;
        rings[i] = point;
        if (level == reach && point.x <= finiteDepths) accompanied = true;
    }
    for (int i = int(gl_LocalInvocationIndex); i < 18 * 18; i += 256) {
        ivec2 at = corner - 1 + ivec2(i % 18, i / 18);
        around[i] = inside(at, pyramid.size.xy) ? depths[pixelOf(at)] : infinity;
    }
    barrier();
}

// Where in rings[] a pixel's ring begins.
int cornerOf(ivec2 at, ivec2 corner, int level) {
    ivec2 own = ringStart(at, level) - ringStart(corner, level);
    return firstOf(level) + own.y * sideOf(level) + own.x;
}

// Where in around[] a pixel's neighbours begin.
int cornerOfPixels() {
    return int(gl_LocalInvocationID.y) * 18 + int(gl_LocalInvocationID.x);
}

// Sectors that leave the picture, as bits: those of which some level but the coarsest has no texel.
uint leavingFrom(ivec2 at, int reach) {
    bvec2 before = lessThan(at - 1, ivec2(0));
    bvec2 behind = greaterThanEqual(at + 1, pyramid.size.xy);
    for (int k = 1; k < reach; ++k) {
        ivec2 start = ringStart(at, k);
        before = bvec2(uvec2(before) | uvec2(lessThan(start, ivec2(0))));
        behind = bvec2(uvec2(behind) | uvec2(greaterThanEqual(start + 3, sizeOf(k))));
    }
    return (before.x ? 0x29u : 0u) | (behind.x ? 0x94u : 0u) | (before.y ? 0x07u : 0u) | (behind.y ? 0xe0u : 0u);
}

// Whether what lies at depth `front` is far enough in front. Nobody is there where that is infinite: background behind
// nobody must not be a matter of infinity minus infinity, since a driver need not know what is not a number.
bool occludes(float front, float depth) {
    precise float gap = depth - front;
    return front <= finiteDepths && gap >= pyramid.hide.x;
}

// Sectors with somebody in front, as bits.
uint occupiedAround(ivec2 at, ivec2 corner, int reach, float depth) {
    float nearest[8] = float[](infinity, infinity, infinity, infinity, infinity, infinity, infinity, infinity);
    int pixels = cornerOfPixels();
#define NEAREST_PIXEL(column, row, sector) nearest[sector] = min(nearest[sector], around[pixels + row * 18 + column]);
    PIXELS(NEAREST_PIXEL)
    for (int level = 1; level <= reach; ++level) {
        int ring = cornerOf(at, corner, level), side = sideOf(level);
#define NEAREST_TEXEL(column, row, sector) nearest[sector] = min(nearest[sector], rings[ring + row * side + column].x);
        RING(NEAREST_TEXEL)
    }
    uint occupied = 0u;
    for (int s = 0; s < 8; ++s) {
        if (occludes(nearest[s], depth)) occupied |= 1u << s;
    }
    return occupied;
}

// A pixel's point; of background, whose point lies at infinity, the way there.
struct Judged {
    vec2 place;
    float depth;
    bool background;
};

Judged judged(ivec2 at, float depth) {
    bool background = depth > finiteDepths;
    vec2 ray = rayOf(vec2(at));
    precise vec2 place = perspective() ? ray * depth : ray;
    return Judged(background ? (perspective() ? ray : vec2(0.0)) : place, depth, background);
}

// The squared cosine between the direction from x to y and that from y to the eye; 0 where y does not occlude.
float squaredCosine(Judged own, vec4 y) {
    if (!occludes(y.x, own.depth)) return 0.0;
    precise float gap = own.depth - y.x;
    precise float dx = own.background ? own.place.x : own.place.x - y.y;
    precise float dy = own.background ? own.place.y : own.place.y - y.z;
    float dz = own.background ? 1.0 : gap;
    precise float distance2 = dx * dx + dy * dy + dz * dz;
    precise float inner = dx * y.y + dy * y.z + dz * y.x;
    float along = perspective() ? (inner > 0.0 ? inner : 0.0) : dz;
    precise float along2 = along * along;
    precise float scale = perspective() ? distance2 * y.w : distance2;
    return quotient(along2, scale);
}

// Sum of 1 - cosine over the sectors that count; `exact`, or an upper bound without roots.
float occlusion(float best[8], uint leaving, bool exact) {
    precise float sum = 0.0;
    for (int s = 0; s < 8; ++s) {
        float bounded = best[s] < 1.0 ? best[s] : 1.0;
        precise float open = 1.0 - (exact ? root(bounded) : bounded);
        if ((leaving >> s & 1u) == 0u) sum += open;
    }
    return sum;
}

bool hiddenByAngles(ivec2 at, ivec2 corner, int reach, Judged own, uint leaving, float limit) {
    float best[8] = float[](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    int pixels = cornerOfPixels();
#define ANGLE(y, sector)                          \
    {                                             \
        float squared = squaredCosine(own, y);    \
        if (squared > best[sector]) best[sector] = squared; \
    }
#define ANGLE_OF_PIXEL(column, row, sector) \
    ANGLE(pointOf(vec2(at + ivec2(column, row) - 1), around[pixels + row * 18 + column]), sector)
    PIXELS(ANGLE_OF_PIXEL)
    for (int level = 1; level <= reach; ++level) {
        if (!(occlusion(best, leaving, false) >= limit)) return true;
        int ring = cornerOf(at, corner, level), side = sideOf(level);
#define ANGLE_OF_TEXEL(column, row, sector) ANGLE(rings[ring + row * side + column], sector)
        RING(ANGLE_OF_TEXEL)
    }
    return occlusion(best, leaving, true) < limit;
}

bool isHidden(ivec2 at, ivec2 corner, int reach, float depth) {
    uint leaving = leavingFrom(at, reach);
    uint occupied = occupiedAround(at, corner, reach, depth);
    int counting = 8 - bitCount(leaving), open = 8 - bitCount(leaving | occupied);
    precise float limit = float(counting) * pyramid.hide.y;
    if (float(open) >= limit) return false;
    Judged own = judged(at, depth);
    if (own.background && open == 0 && float(reach) <= pyramid.hide.z) return true;
    return hiddenByAngles(at, corner, reach, own, leaving, limit);
}

// Labels a pixel, and adds to the sums where it is visible.
void judge(ivec2 at, ivec2 corner, int reach) {
    uint label = backgroundLabel;
    if (accompanied) {
        float depth = around[cornerOfPixels() + 19];
        uint seen = depth > finiteDepths ? backgroundLabel : foregroundLabel;
        label = isHidden(at, corner, reach, depth) ? hiddenLabel : seen;
        if (label == foregroundLabel) {
            atomicAdd(sizes, closingAt(depth));
            atomicAdd(visible, 1);
        }
    }
    labels[pixelOf(at)] = label;
}

void main() {
    ivec2 block = ivec2(gl_WorkGroupID.xy), corner = 16 * block, at = ivec2(gl_GlobalInvocationID.xy);
    float nearest = depthOf(block);
    int reach = reachOf(nearest);
    loadNeighbours(corner, reach);
    if (inside(at, pyramid.size.xy)) judge(at, corner, reach);
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        closing[block.y * pyramid.blocks.x + block.x] = visible > 0 ? sizes / visible : -1 - closingAt(nearest);
}
