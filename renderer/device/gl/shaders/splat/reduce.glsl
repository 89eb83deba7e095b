// A pyramid upwards, six levels at a time: a work group takes 64 x 64 texels of level `baseLevel` and writes what becomes
// of them in the six levels above, which are the work of nobody else. Whoever includes this defines fineTexel(), a
// texel of that level, and mergedOf(), one of four, of which all that lie outside are `nothing`.

layout(local_size_x = 256) in;

layout(location = 0) uniform uint baseLevel;

// The last two levels: the first 32 x 32 texels are odd steps', the others even steps'.
shared vec4 texels[32 * 32 + 16 * 16];

vec4 fineTexel(int base, ivec2 at);
vec4 mergedOf(vec4 a, vec4 b, vec4 c, vec4 d);

void reduce() {
    int base = int(baseLevel);
    ivec2 tile = ivec2(gl_WorkGroupID.xy);
    for (int up = 1; up <= 6 && base + up < pyramid.size.z; ++up) {
        int side = 64 >> up, own = (up & 1) != 0 ? 0 : 1024, below = 1024 - own;
        ivec2 size = sizeOf(base + up);
        for (int i = int(gl_LocalInvocationID.x); i < side * side; i += 256) {
            ivec2 at = ivec2(i & (side - 1), i >> (6 - up));
            ivec2 texel = tile * side + at;
            vec4 merged;
            if (up == 1) {
                merged = mergedOf(fineTexel(base, 2 * texel), fineTexel(base, 2 * texel + ivec2(1, 0)),
                                  fineTexel(base, 2 * texel + ivec2(0, 1)), fineTexel(base, 2 * texel + 1));
            } else {
                int first = below + 4 * side * at.y + 2 * at.x;
                merged = mergedOf(texels[first], texels[first + 1], texels[first + 2 * side],
                                  texels[first + 2 * side + 1]);
            }
            texels[own + i] = merged;
            if (inside(texel, size)) above[placeOf(base + up, texel)] = merged;
        }
        barrier();
    }
}
