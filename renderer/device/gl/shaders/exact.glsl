// Quotients and square roots rounded to the nearest float, ties to even, as IEEE 754 and the cpu device round them. A driver's
// own may be off: OpenGL allows a quotient 2.5 units in the last place, and a root as much as 1 / inversesqrt() (GLSL 4.50,
// 4.7.1). Compiled by C++, too (tests/unit/gl/exact_test.cpp). After Muller et al., "Handbook of Floating-Point
// Arithmetic", 2018, sections 4.4, 4.7 and 5.2. Variants, the same in all shaders of a device (arithmetic.hpp):
// ROUNDING: the driver's own are exact; or corrected, by fma() or, where that rounds twice, by split factors. ROUGH 1: for
// tests, the driver's own are spoilt as far as OpenGL allows.
#define ROUNDING_OWN 0
#define ROUNDING_BY_FMA 1
#define ROUNDING_BY_SPLITTING 2

#if ROUGH
// Some units in the last place, -2 to 2, more or less at random.
float spoilt(float value, uint a, uint b) {
    uint mixed = (a ^ (b << 7) ^ (b >> 3)) * 2654435761u;
    int units = int((mixed >> 16) % 5u) - 2;
    uint magnitude = floatBitsToUint(value) & 0x7fffffffu;
    bool ordinary = magnitude > 0x01000000u && magnitude < 0x7e000000u;
    return ordinary ? intBitsToFloat(floatBitsToInt(value) + units) : value;
}
#else
#define spoilt(value, a, b) (value)
#endif

float ownQuotient(float a, float b) {
    precise float own = a / b;
    return spoilt(own, floatBitsToUint(a), floatBitsToUint(b));
}

float ownRoot(float x) {
    precise float own = sqrt(x);
    return spoilt(own, floatBitsToUint(x), 1u);
}

#if ROUNDING == ROUNDING_OWN
float quotient(float a, float b) { return ownQuotient(a, b); }
float root(float x) { return ownRoot(x); }
#else

#if ROUNDING == ROUNDING_BY_FMA
// c - a * b, rounded once: exactly, where it has few enough bits.
float residual(float a, float b, float c) {
    precise float left = fma(-a, b, c);
    return left;
}
#else
// The upper twelve bits, so that products of such halves are exact (Veltkamp).
float upperHalf(float v) {
    precise float scaled = 4097.0 * v;
    precise float rest = scaled - v;
    precise float upper = scaled - rest;
    return upper;
}

// c - a * b for a product that is nearly c: what is lost of the product is known exactly (Dekker).
float residual(float a, float b, float c) {
    float a1 = upperHalf(a), b1 = upperHalf(b);
    precise float a2 = a - a1, b2 = b - b1;
    precise float product = a * b;
    precise float lost = (((a1 * b1 - product) + a1 * b2) + a2 * b1) + a2 * b2;
    precise float left = (c - product) - lost;
    return left;
}
#endif

// Within these bounds nothing overflows, and nothing is so small that bits are lost; beyond, the driver's own must do.
bool correctable(float v) {
    return abs(v) >= 3.5527137e-15 && abs(v) <= 2.8147498e14;  // 2^-48, 2^48
}

// The next float away from zero, or towards it.
float neighbour(float v, bool away) {
    return intBitsToFloat(floatBitsToInt(v) + (away ? 1 : -1));
}

float quotient(float a, float b) {
    float own = ownQuotient(a, b);
    if (!correctable(a) || !correctable(b)) return own;
    precise float close = own + residual(own, b, a) * ownQuotient(1.0, b);
    // Now less than a unit off. The residual tells on which side, and whether the neighbour there is nearer: a quotient
    // is never half-way between two.
    float left = residual(close, b, a);
    bool larger = (left < 0.0) == (b < 0.0);
    float other = neighbour(close, larger == (close > 0.0));
    precise float unit = other - close;
    precise float gain = 2.0 * abs(left) - abs(unit * b);
    return gain > 0.0 ? other : close;
}

float root(float x) {
    float own = ownRoot(x);
    if (!correctable(x)) return own;
    precise float close = own + residual(own, own, x) * ownQuotient(0.5, own);
    // (s + u/2)^2 = s^2 + s*u + u^2/4, and all but the last are multiples of more than that.
    float left = residual(close, close, x);
    bool larger = left > 0.0;
    float other = neighbour(close, larger);
    precise float unit = other - close;
    precise float rise = close * unit;
    return larger ? (left > rise ? other : close) : (left <= rise ? other : close);
}
#endif
