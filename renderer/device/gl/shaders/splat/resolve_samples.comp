// resolve, second step where payloads are ordinals: the colours and normals of the pixels whose samples lie in one page.
// Variants: KEYS64, COLORING, BY_INTENSITY, NORMALS 0 or 1, CURVED, OWNERS.
#version 450 core
#include "splat_kinds.glsl"
#include "layouts_splat.glsl"
#include "exact.glsl"
#include "formulas.glsl"
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
#if OWNERS
layout(std430, binding = 0) writeonly buffer Places { uint places[]; };
layout(std430, binding = 4) writeonly buffer Halves { float halves[]; };
#endif

#include "splat_tables.glsl"
#include "sample_places.glsl"
#include "colors.glsl"
#include "sample_normals.glsl"
#include "normal_plane.glsl"
#if CURVED
#if COLORING != COLOR_CURVATURE && COLORING != COLOR_INFRARED
#include "beside.glsl"
#endif
#include "ellipses.inl"
#include "axes.glsl"
#include "bends.glsl"
#endif
#if OWNERS
#include "owners.glsl"
#endif

#if CURVED
// The normal at a pixel of the picture that the surface is seen in: n + k1 (away . e1) e1 + k2 (away . e2) e2.
vec3 bentNormal(RunParams run, uvec4 words, uint code, ivec2 at, float there) {
    vec3 centre = centreOf(run, words);
    float spread = pass.view.w != 0.0 ? there : 1.0;
    precise float dx = (float(at.x) + 0.5) - pass.view.x;
    precise float dy = (float(at.y) + 0.5) - pass.view.y;
    precise float ax = (dx * spread - centre.x) * pass.view.z;
    precise float ay = (centre.y - dy * spread) * pass.view.z;
    precise float az = centre.z - there;
    vec3 cloud = sampleNormal(words.w), n = toView(cloud);
    Bend b = bendOf(run, cloud, n, code);
    precise float along1 = (ax * b.e1.x + (ay * b.e1.y + az * b.e1.z)) * b.k1;
    precise float along2 = (ax * b.e2.x + (ay * b.e2.y + az * b.e2.z)) * b.k2;
    float turn1 = max(min(along1, 1.0), -1.0), turn2 = max(min(along2, 1.0), -1.0);
    precise vec3 bent = n + (turn1 * b.e1 + turn2 * b.e2);
    return b.k1 == 0.0 && b.k2 == 0.0 ? toView(sampleDirection(words.w)) : bent;
}
#endif

// The last of the page's extents that begins at or before the ordinal; it may end before it, too.
SplatExtent extentOf(uint ordinal) {
    uint low = pass.look.x, high = pass.look.x + pass.look.y;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (extents[middle].range.x <= ordinal) low = middle;
        else high = middle;
    }
    return extents[low];
}

void main() {
    ivec2 at;
    uint pixel, place;
    if (!pixelHere(at, pixel, place)) return;
    float there = depth[place];
    if (floatBitsToUint(there) >= infiniteOrder) return;
    uint ordinal = keyPayload(pixel);
    SplatExtent extent = extentOf(ordinal);
    uint i = ordinal - extent.range.x, beside = extent.beside.x + i;
    if (ordinal < extent.range.x || i >= extent.range.y) return;
    uvec4 words = texelFetch(samples, int(extent.range.w + i));
    rgba[place] = colorOf(runs[extent.range.z], words, beside, there) | 0xff000000u;
#if OWNERS
    Owner owner = ownerOf(runs[extent.range.z], words, at + pass.area.xy);
    places[place] = owner.place;
    halves[place] = owner.halfPx;
#endif
#if NORMALS
#if CURVED
    uint code = besideAt(runs[extent.range.z], beside) & curvatureBits;
    if (code != 0u && (words.w & 0xffffu) != 0u) {
        normals[place] = packNormal(bentNormal(runs[extent.range.z], words, code, at + pass.area.xy, there));
        return;
    }
#endif
    normals[place] = packNormal(toView(sampleDirection(words.w)));
#endif
}
