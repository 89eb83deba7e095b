// log2 and 2^x as the cpu device computes them (kernels/screen.hpp), operation by operation: a driver's own differ
// from one to the next. Needs exact.glsl.

float log2Of(float value) {
    int bits = floatBitsToInt(value);
    int exponent = (bits - 0x3f3504f3) >> 23;
    float m = intBitsToFloat(bits - exponent * (1 << 23));
    precise float below = m - 1.0, above = m + 1.0;
    precise float s = quotient(below, above);
    precise float s2 = s * s;
    precise float series = 0.41219858 + s2 * 0.32059890;
    precise float log2m = s * (2.88539008 + s2 * (0.96179669 + s2 * (0.57707802 + s2 * series)));
    precise float sum = float(exponent) + log2m;
    return sum;
}

// For x <= 0.
float exp2Of(float x) {
    float bounded = x > -120.0 ? x : -120.0;
    precise float whole = floor(bounded + 0.5);
    precise float f = bounded - whole;
    precise float tail = 0.0013333558 + f * 0.00015403530;
    precise float p = 1.0 + f * (0.69314718 + f * (0.24022651 + f * (0.055504109 + f * (0.0096181291 + f * tail))));
    precise float scaled = p * intBitsToFloat((int(whole) + 127) * (1 << 23));
    return x < -120.0 ? 0.0 : scaled;
}
