// The words that renderer/device/formulas is written in, for shaders: a REAL is one float. cpu/kernels/formulas.hpp has them for vectors.
// Whoever includes one of those files includes this and exact.glsl before it. Operation by operation, because a driver would put them in
// another order.
#define CONSTANT const
#define FORMULA
#define PRECISE precise
#define REAL float
#define WHOLE int
#define MASK bool
#define OUT(type) out type
#define ALL(value) (value)
#define AND(a, b) ((a) && (b))
#define LARGER(a, b) larger(a, b)
#define SMALLER(a, b) smaller(a, b)
#define FLOOR(value) floor(value)
#define TO_REAL(whole) float(whole)
#define TO_WHOLE(real) int(real)
#define BITS(real) floatBitsToInt(real)
#define REAL_OF_BITS(whole) intBitsToFloat(whole)
#define QUOTIENT(a, b) quotient(a, b)
#define ROOT(value) root(value)

// The second one where either is not a number.
float larger(float a, float b) { return a > b ? a : b; }
float smaller(float a, float b) { return a < b ? a : b; }

#include "constants.inl"
