// What all samples of a layer look up. Words from `normalWords` on are 65,536 colours of normals, where those are asked
// for, and then the runs' regions: a count of planes and six rows of four floats each.
layout(std430, binding = 3) readonly buffer Tables { uint tables[]; };

const uint rampWords = 0u;      // 256 colours
const uint classWords = 256u;   // 256 flags, 1 = drawn
const uint radiusWords = 512u;  // 256 radii in the node's unit; 0 = none
const uint axisWords = 768u;    // 32 cosines and 32 sines of the angles that ellipses may have
const uint factorWords = 832u;  // 256 factors of brightness by intensity, in 256ths
const uint curvatureWords = 1088u;  // 256 curvatures by byte, in 1 / radiusUnit
const uint normalWords = 1344u;
const uint regionWords = 25u;   // of one region
