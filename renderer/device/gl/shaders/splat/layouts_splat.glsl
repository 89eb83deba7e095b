// What splat passes and their resolving share with C++: compiled by both (splat_layouts.hpp checks the offsets). Only
// 16-byte members, so that std140, std430 and C++ lay them out alike. From host/splat_numbers.hpp, word for word.

// One splat pass over an area of the picture.
struct SplatParams {
    vec4 view;         // centre of the view axis x and y, px in the whole picture, jitter included; near; far
    ivec4 area;        // x, y, width, height of the pixels that there are, px in the whole picture
    vec4 size;         // smallest and largest splat, px; world radius per px (times depth in perspective); gain
    vec4 ramp;         // colour index = (value - x) * y, clamped to the ramp; a factor's = (intensity - z) * w
    vec4 surfel;       // pixels per unit; units per pixel; scale of radii; largest half size, px
    vec4 extent;       // Sum of discs: reach, and its largest half size, px; tolerance, drawn radii; unused
    vec4 blur;         // Ellipse: 6 and sqrt(6) times the low-pass' variance and deviation, px; an ellipse's major axis over its radius,
                       // and a step of its axes' ratio (renderer/cloud/surfel_bytes.hpp), 0 for circles
    vec4 rotation[3];  // rows: cloud -> view space (x right, y up, z towards the viewer)
    ivec4 flags;       // which of a run's size factors; facing: 1, -1 or 0; unused; 1 = samples know radii
    ivec4 filters;     // x: 1 = not all classes are drawn; y: 1 = outliers are drawn; unused
};

// One run of samples of the cut, composed in double on the host.
struct RunParams {
    vec4 toPicture[3];  // rows times (x, y, z, 1): across, down, px (times depth in perspective); depth
    ivec4 clipMin;      // integers of the samples inside the clip box, inclusive; w: first word of its regions
    ivec4 clipMax;      // w: regions in which its samples are dropped; from the 16th bit on those, after them, in which alone they are kept
    vec4 sizeFactors;   // by pass: size of sprites = this * ratio (over depth in perspective)
    vec4 factors;       // colour index = value * .x + .y; z: unit of the samples' radii over the run's; w: that
    uvec4 color;        // x: of every sample where the source is one per run; y: last turn (fade.hpp); z: ordinal of
                        // the first sample; w: 1 = oriented, 2 = something stands beside its samples
};

// Up to CHUNK_SAMPLES samples of one run: the work of one work group.
struct SplatChunk {
    uvec4 range;   // first sample in its page, samples, run, the first one's index in the run
    uvec4 beside;  // the first one's word beside it in the page, counted in words; unused
};

// Samples of one run side by side in a page: where ordinals lead to. Those of a page are sorted by ordinal.
struct SplatExtent {
    uvec4 range;   // ordinal of the first sample, samples, run, the first one's place in the page
    uvec4 beside;  // the first one's word beside it in the page, counted in words; unused
};

// What splat passes left of an area -> planes of pixels.
struct ResolveParams {
    ivec4 area;        // x, y, width, height, px in the whole picture
    ivec4 planes;      // the same of the planes, which hold the area
    vec4 ramp;         // as SplatParams has it
    uvec4 look;        // the page's first extent, and how many; first row of the background; unused
    vec4 rotation[3];  // as SplatParams has it
    vec4 view;         // centre of the view axis x and y, px in the whole picture; units per pixel; 1 = perspective
    vec4 sprite;       // smallest and largest splat, px; 1 = samples know radii; unused
};

// Borders of paraboloids, smoothed.
struct SmoothParams {
    ivec4 size;  // width, height of the planes; 1 = perspective; 1 = squares
    vec4 bulge;  // x: how far the border lies behind the centre, over half a splat's size in px (and over depth)
};
