// What C++ and the shaders of screen passes share: compiled by both (screen_layouts.hpp checks the offsets). Only
// 16-byte members, so that std140 and C++ lay them out alike. Planes are GpuPlanes (planes.hpp).

// Blinn-Phong.
struct PhongParams {
    ivec4 size;   // width, height of the planes; their first pixel in the picture
    vec4 eye;     // centre of the picture's pixel (0, 0), px right of and below the view axis; 1/f, 0 = orthographic
    vec4 shares;  // ambient, headlight, sunlight, shine
    vec4 sun;     // the way to it, view space
};

// Eye-dome lighting.
struct EyeDomeLight {
    ivec4 size;        // width, height of the planes
    ivec4 offsets[4];  // of the eight neighbours, px: x0, y0, x1, y1, ...
    vec4 strength;     // x: shade = 2^(-x * sum of the eight responses)
};

// Ambient occlusion (screen_numbers.hpp).
#ifndef SCANCAST_SCREEN_NUMBERS
const int occlusionPairs = 24;
const float occlusionFull = 1.5, occlusionFall = 0.4;
#endif

struct OcclusionParams {
    ivec4 size;                   // width, height of the planes
    ivec4 pairs[occlusionPairs];  // of one of each pair of neighbours, px: x, y; bits of the float perPx
    vec4 strength;                // x: shade = 2^(-x * sum over the pairs); y: not 0 = perspective
};

// Shadows.
struct ShadowParams {
    ivec4 size;      // width, height of the planes; their first pixel in the picture
    ivec4 map;       // its width, height; not 0 = perspective
    vec4 u;          // where a pixel lies in the map (screen_numbers.hpp) ...
    vec4 v;
    vec4 depth;      // ... and how deep
    vec4 strength;   // strength, bias, share
};

// A part of planes, and an average over frames of it.
struct PartParams {
    ivec4 area;    // of the planes: x, y, width, height
    ivec4 window;  // the part, likewise
    uvec4 frames;  // how many the average is of; so far, of accumulate.comp
};

// A mirror's glass: plan/screen_numbers.hpp says what is linear in the pixel.
struct GlassParams {
    ivec4 picture;    // area of the picture's planes: x, y, width, height
    ivec4 reflected;  // of the reflection's
    vec4 depthAt;     // at pixel (0, 0), step in x, step in y; w: margin
    vec4 rightAt;     // likewise; w: 1 in perspective, else 0
    vec4 upAt;
    ivec4 tint;       // w: 1 where there are normals, else 0
};

// Labels of hidden points as colours.
struct VisibilityParams {
    ivec4 size;    // width, height of the planes
    uvec4 colors;  // of visible points, hidden ones, holes
};

const int pyramidLevels = 24;

// The passes of docs/spec/pyramid.md section 1. Level 0 is the picture; texels of the others stand in one buffer.
struct PyramidParams {
    ivec4 size;                   // width, height of the picture; levels; the coarsest that a neighbourhood may use
    vec4 layerView;                   // view axis x, y, px; units per px (times depth in perspective); 1 in perspective, else 0
    ivec4 levels[pyramidLevels];  // width, height, first texel
    vec4 farthest[6];             // by level, four in one: whoever is not farther has neighbours in it
    vec4 hide;                    // least gap; threshold; up to this level neighbours all around hide what is at infinity
    vec4 normals;                 // normalScale * s0 * f, px * depth (orthographic: px); least px
    vec4 closing;                 // eighths of a px: size of a closing * depth (orthographic: size), least, most; least depth
    ivec4 blocks;                 // in a row; rows; the widest closing, px
    ivec4 normalLevels;           // the finest above the picture that some pixel needs; how many levels have normals
};
