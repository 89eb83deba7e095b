// The formulas that both devices compute (renderer/device/formulas), on vectors: the same text is a shader's (gl/shaders/formulas.glsl),
// where a REAL is one float. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/vectors.hpp"
#include "renderer/device/host/constants.hpp"

namespace scancast::cpu {
namespace {

#define FORMULA \
    [[gnu::always_inline]] inline  // as templates of one use were: a call would cost more than most of them
#define PRECISE  // nothing is contracted or put in another order here (ScancastCompiler.cmake)
#define REAL FloatW
#define WHOLE IntW
#define MASK IntW
#define OUT(type) type&
#define ALL(value) all(value)
#define AND(a, b) ((a) & (b))
#define LARGER(a, b) larger(a, b)
#define SMALLER(a, b) smaller(a, b)
#define FLOOR(value) floorOf(value)
#define TO_REAL(whole) toFloat(whole)
#define TO_WHOLE(real) toInt(real)
#define BITS(real) reinterpret_cast<IntW>(real)
#define REAL_OF_BITS(whole) reinterpret_cast<FloatW>(whole)
#define QUOTIENT(a, b) ((a) / (b))
#define ROOT(value) squareRoot<wideLanes>(value)

#include "renderer/device/formulas/ellipses.inl"
#include "renderer/device/formulas/light.inl"
#include "renderer/device/formulas/powers.inl"
#include "renderer/device/formulas/surfaces.inl"

#undef FORMULA
#undef PRECISE
#undef REAL
#undef WHOLE
#undef MASK
#undef OUT
#undef ALL
#undef AND
#undef LARGER
#undef SMALLER
#undef FLOOR
#undef TO_REAL
#undef TO_WHOLE
#undef BITS
#undef REAL_OF_BITS
#undef QUOTIENT
#undef ROOT

}  // namespace
}  // namespace scancast::cpu
