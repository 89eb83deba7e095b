// The second half of pull-push, six levels at a time: what is not known is interpolated from the level above, with
// weights 9, 3, 3, 1; on the picture, hidden pixels are. docs/spec/pyramid.md section 5; as the cpu device computes it
// (kernels/pull_push.hpp).
//
// A work group takes 64 x 64 texels of level `base`. Of the levels above it works out all that they depend on, one
// texel more on every side than it owns, and writes what it owns. From pulled texels to filled ones: a neighbour's
// would else change while they are read.
#version 450 core
#include "layouts_screen.glsl"
#include "pyramid.glsl"

layout(local_size_x = 256) in;

layout(std430, binding = 0) buffer Colors { uint colors[]; };
layout(std430, binding = 1) buffer Depths { float depths[]; };
layout(std430, binding = 3) readonly buffer Labels { uint labels[]; };
layout(std430, binding = 4) buffer Filled { vec4 filled[]; };
layout(std430, binding = 5) readonly buffer Pulled { vec4 pulled[]; };
layout(location = 0) uniform uint baseLevel;

// Two levels: odd steps above `base`, 34 x 34 at most, and even ones, 18 x 18.
const int evenSteps = 34 * 34;
shared vec4 texels[34 * 34 + 18 * 18];

const uint hidden = 0u;

// One level's texels in shared memory: those that the group owns, and one more on every side. Beyond the level's
// border stands the nearest inside.
struct Part {
    int first;     // in texels[]
    int side;
    ivec2 corner;  // the first one's place in its level
};

Part partOf(int up) {
    int owned = 64 >> up;
    return Part((up & 1) != 0 ? 0 : evenSteps, owned + 2, ivec2(gl_WorkGroupID.xy) * owned - 1);
}

bool owns(Part part, ivec2 at) {
    return inside(at - part.corner - 1, ivec2(part.side - 2));
}

vec4 texelOf(Part part, int x, int y) {
    return texels[part.first + (y - part.corner.y) * part.side + (x - part.corner.x)];
}

// At a texel of the level below `coarse`.
vec4 interpolated(Part coarse, ivec2 at) {
    ivec2 covering = at >> 1, other = covering + 2 * (at & 1) - 1;
    vec4 near = texelOf(coarse, covering.x, covering.y);
    vec4 nearOther = texelOf(coarse, other.x, covering.y);
    vec4 far = texelOf(coarse, covering.x, other.y);
    vec4 farOther = texelOf(coarse, other.x, other.y);
    precise vec4 value = (near * 9.0 + (nearOther + far) * 3.0 + farOther) * 0.0625;
    return value;
}

// What the steps begin with: the top of the pyramid, or what the levels above were filled to.
void loadTop(int level, int up) {
    Part part = partOf(up);
    bool top = level + 1 == pyramid.size.z;
    ivec2 size = sizeOf(level);
    for (int i = int(gl_LocalInvocationID.x); i < part.side * part.side; i += 256) {
        ivec2 at = part.corner + ivec2(i % part.side, i / part.side);
        int place = placeOf(level, clamp(at, ivec2(0), size - 1));
        vec4 texel = top ? pulled[place] : filled[place];
        texels[part.first + i] = texel;
        if (top && inside(at, size) && owns(part, at)) filled[place] = texel;
    }
}

// A level above `base`, into shared memory.
void pushLevel(int level, int up) {
    Part part = partOf(up), coarse = partOf(up + 1);
    ivec2 size = sizeOf(level);
    for (int i = int(gl_LocalInvocationID.x); i < part.side * part.side; i += 256) {
        ivec2 at = part.corner + ivec2(i % part.side, i / part.side);
        ivec2 nearest = clamp(at, ivec2(0), size - 1);
        int place = placeOf(level, nearest);
        vec4 texel = pulled[place];
        if (texel.x > finiteDepths) texel = interpolated(coarse, nearest);
        texels[part.first + i] = texel;
        if (at == nearest && owns(part, at)) filled[place] = texel;
    }
}

void pushPixel(Part coarse, ivec2 at) {
    int pixel = pixelOf(at);
    if (labels[pixel] != hidden) return;
    vec4 value = interpolated(coarse, at);
    precise vec3 rounded = value.yzw + 0.5;
    uvec3 color = uvec3(rounded);
    colors[pixel] = 0xff000000u | color.x | color.y << 8 | color.z << 16;
    depths[pixel] = value.x;
}

// Level `base` itself.
void pushBase(int base) {
    Part coarse = partOf(1);
    ivec2 size = sizeOf(base);
    for (int i = int(gl_LocalInvocationID.x); i < 64 * 64; i += 256) {
        ivec2 at = 64 * ivec2(gl_WorkGroupID.xy) + ivec2(i & 63, i >> 6);
        if (!inside(at, size)) continue;
        if (base == 0) {
            pushPixel(coarse, at);
        } else {
            int place = placeOf(base, at);
            vec4 texel = pulled[place];
            filled[place] = texel.x > finiteDepths ? interpolated(coarse, at) : texel;
        }
    }
}

void main() {
    int base = int(baseLevel), up = min(6, pyramid.size.z - 1 - base);
    loadTop(base + up, up);
    barrier();
    while (--up > 0) {
        pushLevel(base + up, up);
        barrier();
    }
    pushBase(base);
}
