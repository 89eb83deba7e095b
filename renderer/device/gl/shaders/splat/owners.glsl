// Whose sprite a pixel shows: where it lies from the centre, and how large it is; placed and sized as project.glsl does it, and as
// the cpu device does (kernels/resolve.hpp). Needs `pass` (ResolveParams), RunParams, exact.glsl and splat_tables.glsl.
// Variants: OWNERS 0 or 1.

// A sample's place: px from the view axis, right and down (times depth in perspective), and depth.
vec3 centreOf(RunParams run, uvec4 words) {
    float sx = float(words.x & 0xffffu), sy = float(words.x >> 16), sz = float(words.y & 0xffffu);
    vec4 a = run.toPicture[0], b = run.toPicture[1], c = run.toPicture[2];
    precise vec3 centre = vec3(a.x * sx + (a.y * sy + (a.z * sz + a.w)), b.x * sx + (b.y * sy + (b.z * sz + b.w)),
                               c.x * sx + (c.y * sy + (c.z * sz + c.w)));
    return centre;
}

#if OWNERS
struct Owner {
    uint place;    // x | y << 16 (placeSteps of host/splat_numbers.hpp)
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
    float radius = pass.sprite.z != 0.0 ? uintBitsToFloat(tables[radiusWords + ((words.w >> 16) & 255u)]) : 0.0;
    precise float known = radius * run.factors.z;
    float ratio = radius > 0.0 ? known : 1.0;
    // Sprites have one splat pass.
    precise float wanted = run.sizeFactors.x * ratio;
    precise float size = wanted * inverse;
    precise float dx = (float(at.x) + 0.5) - x;
    precise float dy = (float(at.y) + 0.5) - y;
    return Owner(placeCode(dx) | placeCode(dy) << 16, 0.5 * clamp(size, pass.sprite.x, pass.sprite.y));
}
#endif
