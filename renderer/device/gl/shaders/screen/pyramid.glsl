// What the shaders of docs/spec/pyramid.md section 2 share. Level 0 is the picture; level k has half the size of level k - 1,
// rounded up. Texels are vec4 whose x is a depth, +infinity = nothing there.

layout(std140, binding = 0) uniform Params { PyramidParams pyramid; };

// No constants: not every compiler evaluates intBitsToFloat before it runs.
#define infinity intBitsToFloat(0x7f800000)
#define nothing vec4(infinity, 0.0, 0.0, 0.0)
// Depths above it are infinite.
const float finiteDepths = 3.4e38;

ivec2 sizeOf(int level) {
    return level == 0 ? pyramid.size.xy : pyramid.levels[level].xy;
}

bool inside(ivec2 at, ivec2 size) {
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size));
}

// Of a level >= 1.
int placeOf(int level, ivec2 at) {
    return pyramid.levels[level].z + at.y * pyramid.levels[level].x + at.x;
}

int pixelOf(ivec2 at) {
    return at.y * pyramid.size.x + at.x;
}

bool perspective() {
    return pyramid.layerView.w != 0.0;
}
