// Whose sprite a pixel shows: where it lies from the centre, and how large it is; placed and sized as project.glsl does it, and as
// the cpu device does (kernels/resolve.hpp). Needs `pass` (ResolveParams), RunParams, exact.glsl and sample_places.glsl.

struct Owner {
    uint place;    // x | y << 16 (placeSteps of formulas/constants.inl)
    float halfPx;  // half the sprite's size
};

uint placeCode(float away) {
    precise float code = away * 256.0 + 32768.5;
    return uint(min(max(code, 0.0), 65535.0));
}

Owner ownerOf(RunParams run, uvec4 words, ivec2 at) {
    vec3 centre = centreOf(run, words);
    float inverse = pass.view.w != 0.0 ? quotient(1.0, centre.z) : 1.0;
    precise float x = pass.view.x + centre.x * inverse;
    precise float y = pass.view.y + centre.y * inverse;
    float ratio = radiusRatio(run, words, pass.sprite.z != 0.0);
    // Sprites have one splat pass.
    precise float wanted = run.sizeFactors.x * ratio;
    precise float size = wanted * inverse;
    precise float dx = (float(at.x) + 0.5) - x;
    precise float dy = (float(at.y) + 0.5) - y;
    return Owner(placeCode(dx) | placeCode(dy) << 16, 0.5 * clamp(size, pass.sprite.x, pass.sprite.y));
}
