// Dilation of the points by discs, then erosion: which background is holes between them. docs/spec/pyramid.md section 4.4;
// as the cpu device computes it (kernels/closing.hpp). A work group is one block of 16 x 16 pixels.
#version 450 core
#include "layouts_screen.glsl"
#include "pyramid.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 1) readonly buffer Depths { float depths[]; };
layout(std430, binding = 3) buffer Labels { uint labels[]; };

#include "closing.glsl"

const uint hiddenLabel = 0u, backgroundLabel = 2u;

// Of the block and those around it.
shared int sizes[3][3];

// Where no point is visible: the least of the blocks around, or what the nearest depth says - which stays where that is
// too wide for a closing.
int settledSize(ivec2 block) {
    int size = closing[block.y * pyramid.blocks.x + block.x];
    if (size >= 0) return size;
    size = -1 - size;
    if ((size >> 3) > pyramid.blocks.z) return size;
    for (int i = 0; i < 25; ++i) {
        ivec2 other = block + ivec2(i % 5, i / 5) - 2;
        if (!inside(other, pyramid.blocks.xy)) continue;
        int beside = closing[other.y * pyramid.blocks.x + other.x];
        if (beside >= 0) size = min(size, beside);
    }
    return size;
}

// The radius of a pixel's disc, eighths of a pixel: bilinear between the middles of blocks.
int radiusAt(ivec2 local) {
    ivec2 first = local >> 3, part = (2 * local - 15) & 31;
    int left = sizes[first.y][first.x] * (32 - part.y) + sizes[first.y + 1][first.x] * part.y;
    int right = sizes[first.y][first.x + 1] * (32 - part.y) + sizes[first.y + 1][first.x + 1] * part.y;
    return (left * (32 - part.x) + right * part.x) >> 10;
}

bool near(ivec2 at, int offset, int radius) {
    ivec2 other = at + ivec2(offset, 0);
    if (!inside(other, pyramid.size.xy)) return false;
    int along = closing[distancePlace(other)];
    return along <= radius && along * along + offset * offset <= radius * radius + radius;
}

bool within(ivec2 at, int radius) {
    for (int offset = 0; offset <= radius; ++offset) {
        if (near(at, offset, radius) || near(at, -offset, radius)) return true;
    }
    return false;
}

void main() {
    int own = int(gl_LocalInvocationIndex);
    if (own < 9) {
        ivec2 block = ivec2(gl_WorkGroupID.xy) + ivec2(own % 3, own / 3) - 1;
        sizes[own / 3][own % 3] = settledSize(clamp(block, ivec2(0), pyramid.blocks.xy - 1));
    }
    barrier();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!inside(at, pyramid.size.xy)) return;
    int wished = radiusAt(ivec2(gl_LocalInvocationID.xy)) >> 3, radius = min(wished, pyramid.blocks.z);
    if (baseLevel == 0u) {
        closing[coveredPlace(at)] = within(at, radius) ? 1 : 0;
    } else if (depths[pixelOf(at)] > finiteDepths && wished <= pyramid.blocks.z) {
        labels[pixelOf(at)] = within(at, radius) ? backgroundLabel : hiddenLabel;
    }
}
