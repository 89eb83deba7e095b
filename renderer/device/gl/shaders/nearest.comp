// nearest: keeps, per pixel, the smallest key order << 32 | payload (methods.md section 3), where there are no 64-bit
// atomics in two dispatches. STAGE 0 keeps the smallest order; in STAGE 1 the samples whose recomputed order equals it
// compete with their payload. Every value that decides is `precise`, so that both stages compute the same bits.
// Variants: STAGE, SHAPE, SINGLE_PIXEL, and those of place_sample.glsl.
#version 450 core
#include "layouts.glsl"

layout(local_size_x = GROUP_SIZE) in;

layout(std140, binding = 0) uniform Params { PassParams pass; };
layout(std430, binding = 0) readonly buffer Samples { uvec4 samples[]; };
layout(std430, binding = 1) readonly buffer Runs { RunParams runs[]; };
layout(std430, binding = 2) readonly buffer Chunks { Chunk chunks[]; };
layout(std430, binding = 3) readonly buffer Colors { uint colorTable[]; };  // 256 ramp, 256 classes, 256 radii, 65,536 normals
layout(std430, binding = 4) buffer Orders { uint orders[]; };
layout(std430, binding = 5) buffer Payloads { uint payloads[]; };
layout(location = 0) uniform uint firstChunk;

#include "place_sample.glsl"

// 8 bits of the squared distance to the centre above the colour.
uint payloadOf(float distance2, float scale, uint color) {
    precise float distance = distance2 * scale;
    return uint(min(distance, 255.0)) << 24 | color;
}

void keep(uint pixel, float order, float distance2, float scale, uint color) {
    uint bits = floatBitsToUint(order);
#if STAGE == 0
    // Most fragments lose; looking first spares them the atomic.
    if (bits < orders[pixel]) atomicMin(orders[pixel], bits);
#else
    if (bits == orders[pixel]) {
        uint payload = payloadOf(distance2, scale, color);
        if (payload < payloads[pixel]) atomicMin(payloads[pixel], payload);
    }
#endif
}

// Its order's growth: gain * R in units of (px/h)^2, px/h or 1.
float riseOf(float depth, float h) {
#if PERSPECTIVE
    precise float radius = (h * pass.size.z) * depth;
#else
    precise float radius = h * pass.size.z;
#endif
    precise float borderDepth = pass.size.w * radius;
#if SHAPE == SPHERE_CIRCLE
    return borderDepth;
#elif SHAPE == CONE_SQUARE || SHAPE == CONE_CIRCLE
    precise float perPx = borderDepth / h;
    return perPx;
#else
    precise float perPx2 = borderDepth / (h * h);
    return perPx2;
#endif
}

float orderOf(float depth, float rise, float distance2, float h) {
    precise float order = depth;
#if SHAPE == SPHERE_CIRCLE
    precise float rest = 1.0 - distance2 / (h * h);
    order = depth + rise * (1.0 - sqrt(max(rest, 0.0)));
#elif SHAPE == CONE_SQUARE || SHAPE == CONE_CIRCLE
    order = depth + rise * sqrt(distance2);
#elif SHAPE == PARABOLOID_SQUARE || SHAPE == PARABOLOID_CIRCLE
    order = depth + rise * distance2;
#endif
    return order;
}

bool covers(float dx, float dy, float distance2, float h) {
#if SHAPE == FLAT_SQUARE || SHAPE == PARABOLOID_SQUARE || SHAPE == CONE_SQUARE
    return dx > -h && dx <= h && dy > -h && dy <= h;
#else
    precise float h2 = h * h;
    return distance2 <= h2;
#endif
}

void drawPixel(Splat splat, uint color) {
    ivec2 at = ivec2(floor(vec2(splat.x, splat.y))) - pass.area.xy;
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, pass.area.zw))) return;
    precise float dx = (floor(splat.x) + 0.5) - splat.x;
    precise float dy = (floor(splat.y) + 0.5) - splat.y;
    precise float distance2 = dx * dx + dy * dy;
    keep(uint(at.y * pass.area.z + at.x), splat.depth, distance2, 510.0, color);
}

void drawSplat(Splat splat, uint color) {
    float h = splat.halfPx;
    ivec2 centre = ivec2(floor(vec2(splat.x, splat.y)));
    precise vec2 low = ceil((vec2(splat.x, splat.y) - h) - 0.5);
    precise vec2 high = floor((vec2(splat.x, splat.y) + h) + 0.5);
    ivec2 first = max(min(ivec2(low), centre), pass.area.xy);
    ivec2 last = min(max(ivec2(high), centre), pass.area.xy + pass.area.zw - 1);
    float rise = riseOf(splat.depth, h);
    float atLeastHalf = max(h, 0.5);
    precise float scale = 127.5 / (atLeastHalf * atLeastHalf);
    for (int row = first.y; row <= last.y; ++row) {
        precise float dy = (float(row) + 0.5) - splat.y;
        uint line = uint((row - pass.area.y) * pass.area.z - pass.area.x);
        for (int column = first.x; column <= last.x; ++column) {
            precise float dx = (float(column) + 0.5) - splat.x;
            precise float distance2 = dx * dx + dy * dy;
            // The pixel of the centre is covered whatever the footprint, at the centre's depth.
            bool isCentre = column == centre.x && row == centre.y;
            if (isCentre || covers(dx, dy, distance2, h)) {
                float order = isCentre ? splat.depth : orderOf(splat.depth, rise, distance2, h);
                keep(line + uint(column), order, distance2, scale, color);
            }
        }
    }
}

void drawSample(RunParams run, uvec4 words) {
    Splat splat = placeSample(pass, run, words);
    if (!splat.drawn) return;
#if STAGE == 0
    uint color = 0u;
#else
    uint color = colorOf(pass, run, words, splat.depth);
#endif
#if SINGLE_PIXEL
    drawPixel(splat, color);
#else
    drawSplat(splat, color);
#endif
}

void main() {
    uvec4 range = chunks[firstChunk + gl_WorkGroupID.x].range;
    RunParams run = runs[range.z];
    for (uint i = gl_LocalInvocationID.x; i < range.y; i += GROUP_SIZE) {
        // Fading levels: the samples whose turn has come (renderer/select/fade.hpp).
        if ((range.w + i) * uint(TURN_STEP) <= run.color.y) drawSample(run, samples[range.x + i]);
    }
}
