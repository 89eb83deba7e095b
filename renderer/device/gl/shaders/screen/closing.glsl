// What the two halves of the closing of the background share (docs/spec/pyramid.md section 4.4; kernels/closing.hpp).
// One buffer: the blocks' sizes; of every pixel a distance along its column, then whether a point covers it.

layout(std430, binding = 6) buffer Closing { int closing[]; };
// 0: distances to points, dilation; 1: distances to what is not covered, erosion.
layout(location = 0) uniform uint baseLevel;

int distancePlace(ivec2 at) {
    return pyramid.blocks.x * pyramid.blocks.y + pixelOf(at);
}

int coveredPlace(ivec2 at) {
    return distancePlace(at) + pyramid.size.x * pyramid.size.y;
}
