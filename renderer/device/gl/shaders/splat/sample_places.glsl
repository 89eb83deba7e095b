// Where a sample of a run lies and how large it is, out of its words. Needs RunParams and splat_tables.glsl.

// Px from the view axis, right and down (times depth in perspective), and depth.
vec3 centreOf(RunParams run, uvec4 words) {
    float sx = float(words.x & 0xffffu), sy = float(words.x >> 16), sz = float(words.y & 0xffffu);
    vec4 a = run.toPicture[0], b = run.toPicture[1], c = run.toPicture[2];
    precise vec3 centre = vec3(a.x * sx + (a.y * sy + (a.z * sz + a.w)), b.x * sx + (b.y * sy + (b.z * sz + b.w)),
                               c.x * sx + (c.y * sy + (c.z * sz + c.w)));
    return centre;
}

// Of its radius to the run's plain one: 1 where no radius is known, or none is asked for.
float radiusRatio(RunParams run, uvec4 words, bool ownRadii) {
    if (!ownRadii) return 1.0;
    float radius = uintBitsToFloat(tables[radiusWords + ((words.w >> 16) & 255u)]);
    precise float ratio = radius * run.factors.z;
    return radius > 0.0 ? ratio : 1.0;
}
