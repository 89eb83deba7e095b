// resolve, first step: keys -> colour and depth; the background where no key is. No normals yet. Where payloads are
// ordinals, colours come from resolve_samples.comp. Variants: KEYS64, BY_SAMPLE, CELLS (depth is the nearest pass'),
// NORMALS, each 0 or 1.
#version 450 core
#include "layouts_splat.glsl"
#include "resolve_area.glsl"
#include "read_keys.glsl"

layout(std430, binding = 0) writeonly buffer Rgba { uint rgba[]; };
layout(std430, binding = 1) writeonly buffer Depth { uint depth[]; };  // bits of floats
layout(std430, binding = 2) writeonly buffer Normals { uint normals[]; };
layout(std430, binding = 3) readonly buffer Background { uint background[]; };  // one rgba per row
#if CELLS
#include "visible_order.glsl"
#endif

uint depthBits(uint pixel, uint order) {
#if CELLS
    return visibleOrder(pixel);
#else
    return order;
#endif
}

void main() {
    ivec2 at;
    uint pixel, place;
    if (!pixelHere(at, pixel, place)) return;
    uint order = keyOrder(pixel), color, bits;
    if (order < infiniteOrder) {
#if BY_SAMPLE
        color = 0xff000000u;
#else
        color = keyPayload(pixel) | 0xff000000u;
#endif
        bits = depthBits(pixel, order);
    } else {
        color = background[pass.look.z + uint(at.y)];
        bits = infiniteOrder;
    }
    rgba[place] = color;
    depth[place] = bits;
#if NORMALS
    normals[place] = 0u;
#endif
}
