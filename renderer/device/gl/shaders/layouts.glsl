// What C++ and the shaders share: compiled by both (gl_layouts.hpp checks the offsets). Only 16-byte members, so that
// std140, std430 and C++ lay them out alike.

// One nearest pass.
struct PassParams {
    vec4 view;    // centre of the view axis x and y, px in the whole picture, jitter included; near; far
    ivec4 area;   // part of the whole picture that is drawn: x, y, width, height
    vec4 size;    // smallest and largest splat, px; world radius per px (times depth in perspective); gain
    vec4 ramp;    // colour index = (value - x) * y, clamped to the ramp
};

// One run of samples of the cut, composed in double on the host.
struct RunParams {
    vec4 toPicture[3];  // rows times (x, y, z, 1): across, down, px (times depth in perspective); depth
    ivec4 clipMin;      // integers of the samples inside the clip box, inclusive
    ivec4 clipMax;
    vec4 factors;       // splat size (over depth in perspective); elevation: colour index = z * .y + .z; w: unit of
                        // the samples' radii over the node's radius, 0 where samples have none
    uvec4 color;        // x: the colour of every sample where the source is one per run; y: last turn (fade.hpp)
};

// Up to chunkSamples samples of one run: the work of one work group.
struct Chunk {
    uvec4 range;  // first sample in its page, samples, run, the first one's index in the run
};

// Eye-dome lighting.
struct EyeDomeParams {
    ivec4 area;         // as of the nearest pass: where depths and colours stand
    ivec4 window;       // what comes out
    ivec4 offsets[4];   // of the eight neighbours, px: x0, y0, x1, y1, ...
    vec4 strength;      // x: shade = 2^(-x * sum of the eight responses)
};
