// A splat pass over samples of one page: silhouette, nearest, cell or sum (renderer/device/pass.hpp). A work group takes
// one chunk; each thread draws its samples' footprints itself, but for the large ones, which are put down in a queue and then
// drawn by all threads together, pixel by pixel. Nothing depends on the order: reductions are integers. Sums may take the chunk part by part,
// each with a tile of pixels in shared memory (sums.glsl).
// Variants: GROUP_SIZE, TURN_STEP, REDUCTION, KEEP, KEYS64, LOOK_FIRST, SHAPE, SINGLE_PIXEL, SHARED_FOOTPRINTS,
// PERSPECTIVE, COLORING, BY_INTENSITY, PAYLOAD, SUM_NORMALS, SUM_TILE, SUM_SIDE, COUNT_ADDS, SILHOUETTE, FILTERS, CURVED.
#version 450 core
#if KEYS64
#extension GL_ARB_gpu_shader_int64 : require
#extension GL_NV_shader_atomic_int64 : require
#endif
#include "splat_kinds.glsl"
#include "layouts_splat.glsl"

layout(local_size_x = GROUP_SIZE) in;

layout(std140, binding = 0) uniform Params { SplatParams pass; };
layout(binding = 0) uniform usamplerBuffer samples;
layout(std430, binding = 1) readonly buffer Runs { RunParams runs[]; };
layout(std430, binding = 2) readonly buffer Chunks { SplatChunk chunks[]; };
layout(location = 0) uniform uint firstChunk;

#include "exact.glsl"
#include "formulas.glsl"
#include "splat_tables.glsl"
#include "ellipses.inl"
#include "axes.glsl"
#include "colors.glsl"
#include "sample_places.glsl"
#include "project.glsl"
#include "visible.glsl"
#include "sample_normals.glsl"
#include "surfaces.inl"
#include "surfaces.glsl"
#include "creases.glsl"
#if REDUCTION == REDUCTION_SUM
#include "sums.glsl"
#else
#include "keys.glsl"
#endif
#if CURVED
#if COLORING != COLOR_CURVATURE && COLORING != COLOR_INFRARED
#include "beside.glsl"
#endif
#include "bends.glsl"
uint bendCode = 0u;  // of the sample that is being set up
#endif
#if SHAPE == SHAPE_DISC || SHAPE == SHAPE_ELLIPSE
#include "surfels.glsl"
#include "surfel_fragments.glsl"
#elif REDUCTION == REDUCTION_SUM
#include "sprite_sums.glsl"
#else
#include "sprites.glsl"
#endif

// What a key carries, or a sum adds, of a sample with this index in its run, and with this word of its page beside it;
// of a surface its pose tells (surfaces.glsl).
uint carriedBy(RunParams run, uvec4 words, uint index, uint beside, float depth) {
#if REDUCTION != REDUCTION_SUM && (PAYLOAD == PAYLOAD_NONE || PAYLOAD == PAYLOAD_SURFACE)
    return 0u;
#elif PAYLOAD == PAYLOAD_SAMPLE
    return run.color.z + index;
#else
    return colorOf(run, words, beside, depth);
#endif
}

// A sample of the chunk, if its turn has come (renderer/select/fade.hpp), placed.
bool placedOf(RunParams run, SplatChunk chunk, uint i, out uvec4 words, out Placed placed) {
    if ((chunk.range.w + i) * uint(TURN_STEP) > run.color.y) return false;
    words = texelFetch(samples, int(chunk.range.x + i));
    return placeSample(run, words, placed);
}

// False: nothing of it lies in the area.
bool footprintOf(RunParams run, SplatChunk chunk, uint i, out Footprint f) {
    uvec4 words;
    Placed placed;
    if (!placedOf(run, chunk, i, words, placed)) return false;
    uint index = chunk.range.w + i, beside = chunk.beside.x + i;
#if CURVED
    bendCode = besideAt(run, beside) & curvatureBits;
#endif
    if (!setUp(run, words, placed, carriedBy(run, words, index, beside, placed.depth), f)) return false;
    f.box = ivec4(max(f.box.xy, pass.area.xy), min(f.box.zw, pass.area.xy + pass.area.zw - 1));
    return f.box.x <= f.box.z && f.box.y <= f.box.w;
}

void drawPixel(Footprint f, ivec2 at) {
    ivec2 place = at - pass.area.xy;
    drawFragment(f, at, uint(place.y * pass.area.z + place.x));
}

void drawAlone(Footprint f) {
#if SINGLE_PIXEL
    drawPixel(f, f.box.xy);
#else
    for (int row = f.box.y; row <= f.box.w; ++row)
        for (int column = f.box.x; column <= f.box.z; ++column) drawPixel(f, ivec2(column, row));
#endif
}

#if SHARED_FOOTPRINTS
shared uint queued;
shared uint queue[CHUNK_SAMPLES];

int pixelsOf(Footprint f) { return (f.box.z - f.box.x + 1) * (f.box.w - f.box.y + 1); }

void drawTogether(Footprint f) {
    int width = f.box.z - f.box.x + 1, pixels = pixelsOf(f);
    for (int i = int(gl_LocalInvocationID.x); i < pixels; i += GROUP_SIZE)
        drawPixel(f, f.box.xy + ivec2(i % width, i / width));
}
#endif

// Samples first .. end - 1 of the chunk.
void drawSamples(RunParams run, SplatChunk chunk, uint first, uint end) {
    Footprint f;
#if SHARED_FOOTPRINTS
    if (gl_LocalInvocationID.x == 0u) queued = 0u;
    barrier();
#endif
    for (uint i = first + gl_LocalInvocationID.x; i < end; i += GROUP_SIZE) {
        if (!footprintOf(run, chunk, i, f)) continue;
#if SHARED_FOOTPRINTS
        if (pixelsOf(f) >= MANY_PIXELS) {
            queue[atomicAdd(queued, 1u)] = i;
            continue;
        }
#endif
        drawAlone(f);
    }
#if SHARED_FOOTPRINTS
    barrier();
    for (uint i = 0u; i < queued; ++i) {
        if (footprintOf(run, chunk, queue[i], f)) drawTogether(f);
    }
#endif
}

#if SUM_TILE > 0
// Sets the bounds of samples first .. end - 1, roughly.
void bound(RunParams run, SplatChunk chunk, uint first, uint end) {
    const int none = 1 << 30;
    barrier();  // nobody needs those before any more
    if (gl_LocalInvocationID.x < 4u) bounds[gl_LocalInvocationID.x] = none;
    if (gl_LocalInvocationID.x == 0u) boundSamples = 0u;
    barrier();
    ivec2 low = ivec2(none), high = ivec2(none);
    uint count = 0u;
    for (uint i = first + gl_LocalInvocationID.x; i < end; i += GROUP_SIZE) {
        uvec4 words;
        Placed placed;
        if (!placedOf(run, chunk, i, words, placed)) continue;
        vec2 at = vec2(placed.x, placed.y);
        float reach = min(roughHalf(run, placed), mostHalf);
        ivec2 begin = max(ivec2(floor(at - reach)), pass.area.xy);
        ivec2 last = min(ivec2(floor(at + reach)), pass.area.xy + pass.area.zw - 1);
        if (any(greaterThan(begin, last))) continue;
        low = min(low, begin);
        high = min(high, -last);
        ++count;
    }
    if (count > 0u) {
        atomicMin(bounds[0], low.x);
        atomicMin(bounds[1], low.y);
        atomicMin(bounds[2], high.x);
        atomicMin(bounds[3], high.y);
        atomicAdd(boundSamples, count);
    }
    barrier();
}

void drawChunk(RunParams run, SplatChunk chunk) {
    uint count = chunk.range.y;
    bound(run, chunk, 0u, count);
    uint part = partOf(count);
    for (uint first = 0u; first < count; first += part) {
        uint end = min(first + part, count);
        if (part < count) bound(run, chunk, first, end);
        setTile();
        emptyTile();
        barrier();
        drawSamples(run, chunk, first, end);
        barrier();
        addTile();
    }
}
#endif

void main() {
    SplatChunk chunk = chunks[firstChunk + gl_WorkGroupID.x];
    RunParams run = runs[chunk.range.z];
#if SUM_TILE > 0
    drawChunk(run, chunk);
#else
    drawSamples(run, chunk, 0u, chunk.range.y);
#endif
}
