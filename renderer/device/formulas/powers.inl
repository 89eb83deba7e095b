// log2 and 2^x: a driver's own, and a C library's, differ from one to the next.

// By halving to [sqrt(1/2), sqrt(2)) and the series of artanh; absolute error below 2 ulp of the result or of 1, whichever is larger.
FORMULA REAL log2Of(REAL value) {
    WHOLE bits = BITS(value);
    WHOLE exponent = (bits - 0x3f3504f3) >> 23;
    REAL m = REAL_OF_BITS(bits - exponent * (1 << 23));
    PRECISE REAL below = m - 1.0f, above = m + 1.0f;
    PRECISE REAL s = QUOTIENT(below, above);
    PRECISE REAL s2 = s * s;
    PRECISE REAL series = 0.41219858f + s2 * 0.32059890f;
    PRECISE REAL log2m = s * (2.88539008f + s2 * (0.96179669f + s2 * (0.57707802f + s2 * series)));
    PRECISE REAL sum = TO_REAL(exponent) + log2m;
    return sum;
}

// For x <= 0, by Taylor's series on [-1/2, 1/2]; relative error below 3e-7, 0 below -120.
FORMULA REAL exp2Of(REAL x) {
    REAL bounded = LARGER(x, ALL(-120.0f));
    PRECISE REAL whole = FLOOR(bounded + 0.5f);
    PRECISE REAL f = bounded - whole;
    PRECISE REAL tail = 0.0013333558f + f * 0.00015403530f;
    PRECISE REAL p =
        1.0f + f * (0.69314718f + f * (0.24022651f + f * (0.055504109f + f * (0.0096181291f + f * tail))));
    PRECISE REAL scaled = p * REAL_OF_BITS((TO_WHOLE(whole) + 127) * (1 << 23));
    return x < -120.0f ? ALL(0.0f) : scaled;
}
