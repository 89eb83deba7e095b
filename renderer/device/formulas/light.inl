// Two-sided Blinn-Phong, docs/spec/shading.md section 2; and what a mirror's glass leaves of a colour.

// `n` and `v`: unit vectors, v to the eye; `sun`: the way to it; `shares`: of ambient light, headlight, sunlight and shine; `seen`: how
// much of the sun is. `diffuse`: a factor of the colour, and `shine`: how far it then goes to white.
FORMULA void blinnPhong(REAL nx, REAL ny, REAL nz, REAL vx, REAL vy, REAL vz, float sunX, float sunY, float sunZ, float ambient,
                        float headlight, float sunlight, float shininess, REAL seen, OUT(REAL) diffuse, OUT(REAL) shine) {
    PRECISE REAL facing = nx * vx + ny * vy + nz * vz;
    // The side that is seen is lit.
    REAL side = facing < 0.0f ? ALL(-1.0f) : ALL(1.0f);
    PRECISE REAL toLampX = vx + lampX, toLampY = vy + lampY;
    PRECISE REAL distance2 = toLampX * toLampX + toLampY * toLampY + vz * vz;
    REAL nearer = QUOTIENT(ALL(1.0f), ROOT(distance2));
    PRECISE REAL mx = toLampX * nearer, my = toLampY * nearer, mz = vz * nearer;
    // Large and near: what is turned a little from it gets hardly less, what is turned away from it still some.
    PRECISE REAL ofLamp = side * (nx * mx + ny * my + nz * mz);
    PRECISE REAL turned = ofLamp * lampScale + lampOffset;
    REAL lamp = LARGER(turned, ALL(0.0f));
    PRECISE REAL ofSun = side * (nx * sunX + ny * sunY + nz * sunZ);
    REAL sun = LARGER(ofSun, ALL(0.0f));
    PRECISE REAL hx = vx + mx, hy = vy + my, hz = vz + mz;
    PRECISE REAL halfway = side * (nx * hx + ny * hy + nz * hz);
    // Neither is ever 0: eye and lamp are before whatever is seen.
    PRECISE REAL length2 = hx * hx + hy * hy + hz * hz;
    PRECISE REAL shining = QUOTIENT(LARGER(halfway, ALL(0.0f)), ROOT(length2));
    for (int doubled = 0; doubled < 6; ++doubled) shining = shining * shining;
    PRECISE REAL soft = lamp * (2.0f - lamp);
    PRECISE REAL light = ambient + headlight * soft + sunlight * (sun * seen);
    PRECISE REAL reflected = shininess * shining;
    diffuse = SMALLER(light, ALL(2.0f));
    shine = reflected;
}

// Colours are r | g << 8 | b << 16 | a << 24, and stay as opaque as they are.

// What brightens bends towards white, and nothing but white becomes so.
FORMULA WHOLE lit(WHOLE rgba, REAL diffuse, REAL shine) {
    REAL less = SMALLER(diffuse, ALL(1.0f));
    PRECISE REAL beyond = diffuse - 1.0f;
    REAL more = LARGER(beyond, ALL(0.0f));
    WHOLE after = rgba & ~0xffffff;
    for (int shift = 0; shift < 24; shift += 8) {
        PRECISE REAL dimmed = TO_REAL((rgba >> shift) & 255) * less;
        PRECISE REAL value = dimmed + dimmed * more * (1.0f - dimmed * 0.003921569f);
        PRECISE REAL shining = value + shine * (255.0f - value) + 0.5f;
        after |= TO_WHOLE(SMALLER(shining, ALL(255.0f))) << shift;
    }
    return after;
}

FORMULA WHOLE shaded(WHOLE rgba, REAL shade) {
    WHOLE after = rgba & ~0xffffff;
    for (int shift = 0; shift < 24; shift += 8) {
        PRECISE REAL value = TO_REAL((rgba >> shift) & 255) * shade + 0.5f;
        after |= TO_WHOLE(value) << shift;
    }
    return after;
}

// round(c * t / 255) of bytes, exactly.
FORMULA WHOLE tinted(WHOLE c, int t) {
    WHOLE v = c * t + 128;
    return (v + (v >> 8)) >> 8;
}

FORMULA WHOLE throughGlass(WHOLE rgba, int red, int green, int blue) {
    return (rgba & ~0xffffff) | tinted(rgba & 255, red) | tinted((rgba >> 8) & 255, green) << 8 |
           tinted((rgba >> 16) & 255, blue) << 16;
}
