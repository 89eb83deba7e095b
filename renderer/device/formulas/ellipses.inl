// Surfels' ellipses: docs/spec/surfels.md sections 2.2 and 4.1.

// exp(-3 x) for x in [0, 1], by the eighth power of a cubic; error below 3e-5, a tenth of a weight's step.
FORMULA REAL bell(REAL x) {
    PRECISE REAL y = x * -0.375f;
    PRECISE REAL p = 1.0f + y * (0.99993855f + y * (0.49703766f + y * 0.14508711f));
    PRECISE REAL p2 = p * p;
    PRECISE REAL p4 = p2 * p2;
    PRECISE REAL p8 = p4 * p4;
    return p8;
}

// The minor half-axis over the major one, of an ellipse byte; the lower five bits are the angle.
FORMULA float ratioOf(int code, float step) {
    PRECISE float ratio = 1.0f - float(code >> 5) * step;
    return ratio;
}

// A direction in a surface, one unit long, of its unit normal in cloud space: Frisvad's frame, turned by an angle.
FORMULA void axisAt(REAL nx, REAL ny, REAL nz, REAL cosine, REAL sine, OUT(REAL) x, OUT(REAL) y, OUT(REAL) z) {
    PRECISE REAL across = nx * nx + ny * ny;
    MASK down = nz < 0.0f;
    MASK pole = AND(down, across == 0.0f);
    PRECISE REAL above = down ? 1.0f - nz : ALL(1.0f);
    PRECISE REAL below = down ? across : 1.0f + nz;
    PRECISE REAL a = QUOTIENT(above, (pole ? ALL(1.0f) : below));
    PRECISE REAL b = -nx * ny * a;
    PRECISE REAL firstX = pole ? ALL(0.0f) : 1.0f - nx * nx * a, secondY = pole ? ALL(0.0f) : 1.0f - ny * ny * a;
    REAL firstY = pole ? ALL(-1.0f) : b, secondX = pole ? ALL(-1.0f) : b;
    PRECISE REAL turnedX = firstX * cosine + secondX * sine;
    PRECISE REAL turnedY = firstY * cosine + secondY * sine;
    PRECISE REAL turnedZ = -(nx * cosine + ny * sine);
    x = turnedX;
    y = turnedY;
    z = pole ? ALL(0.0f) : turnedZ;
}
