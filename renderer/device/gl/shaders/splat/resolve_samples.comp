// resolve, second step where payloads are ordinals: the colours and normals of the pixels whose samples lie in one page.
// Variants: KEYS64, COLORING, BY_INTENSITY, NORMALS 0 or 1.
#version 450 core
#include "splat_kinds.glsl"
#include "layouts_splat.glsl"
#include "exact.glsl"
#include "resolve_area.glsl"
#include "read_keys.glsl"

layout(binding = 0) uniform usamplerBuffer samples;
layout(std430, binding = 1) readonly buffer Runs { RunParams runs[]; };
layout(std430, binding = 2) readonly buffer Extents { SplatExtent extents[]; };
layout(std430, binding = 6) buffer Rgba { uint rgba[]; };
layout(std430, binding = 7) readonly buffer Depth { float depth[]; };
#if NORMALS
layout(std430, binding = 5) writeonly buffer Normals { uint normals[]; };
#endif

#include "splat_tables.glsl"
#include "colors.glsl"
#include "sample_normals.glsl"
#include "normal_plane.glsl"

// The last of the page's extents that begins at or before the ordinal; it may end before it, too.
uvec4 extentOf(uint ordinal) {
    uint low = pass.look.x, high = pass.look.x + pass.look.y;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (extents[middle].range.x <= ordinal) low = middle;
        else high = middle;
    }
    return extents[low].range;
}

void main() {
    ivec2 at;
    uint pixel, place;
    if (!pixelHere(at, pixel, place)) return;
    float there = depth[place];
    if (floatBitsToUint(there) >= infiniteOrder) return;
    uint ordinal = keyPayload(pixel);
    uvec4 extent = extentOf(ordinal);
    if (ordinal < extent.x || ordinal - extent.x >= extent.y) return;
    int sampleAt = int(extent.w + (ordinal - extent.x));
    uvec4 words = texelFetch(samples, sampleAt);
    rgba[place] = colorOf(runs[extent.z], words, sampleAt, there) | 0xff000000u;
#if NORMALS
    normals[place] = packNormal(toView(sampleDirection(words.w)));
#endif
}
