// What runs' numbers are composed of: compiled by C++, too, as layouts_splat.glsl is. Doubles, since nodes lie far from the eye.

// One run of samples of the cut: what stays while the camera moves, told once.
struct RunFacts {
    dvec4 corner;   // that its samples count from; w: one step across
    dvec4 steps;    // steps along the other two axes; unused
    ivec4 clipMin;  // these four as RunParams has them
    ivec4 clipMax;
    vec4 factors;
    uvec4 color;
};

// Where they are seen from.
struct ComposeParams {
    dvec4 columns[4];  // cloud -> view space
    dvec4 scale;       // px per unit, times 1, -1; -1; what is not smaller is too large
    dvec4 sizes;       // scale of radii by pass; 0: it is not of sprites
    uvec4 count;       // of runs; unused
    uvec4 unused;
};
