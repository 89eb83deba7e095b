// Quotients and roots as shaders round them (shaders/exact.glsl, compiled by C++ here), where the driver's
// own are off by up to two units in the last place. Oracle: the processor's, which IEEE 754 rounds. That
// decides a picture's bytes on graphics cards, whose own quotients and roots OpenGL lets be off.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "tests/support/sized.hpp"

namespace scancast::gl {
namespace {

using uint = std::uint32_t;
uint floatBitsToUint(float v) {
    return std::bit_cast<uint>(v);
}
int floatBitsToInt(float v) {
    return std::bit_cast<int>(v);
}
float intBitsToFloat(int v) {
    return std::bit_cast<float>(v);
}

#define precise
#define ROUGH 1
namespace by_fma {
using std::abs, std::fma, std::sqrt;
#define ROUNDING 1
#include "renderer/device/gl/shaders/exact.glsl"
#undef ROUNDING
}  // namespace by_fma

#undef ROUNDING_OWN
#undef ROUNDING_BY_FMA
#undef ROUNDING_BY_SPLITTING
namespace by_splitting {
using std::abs, std::sqrt;
#define ROUNDING 2
#include "renderer/device/gl/shaders/exact.glsl"
#undef ROUNDING
}  // namespace by_splitting
#undef precise

struct Rounded {
    const char* name;
    float (*quotient)(float, float);
    float (*root)(float);
    float (*ownQuotient)(float, float);
    float (*ownRoot)(float);
};

class Exact : public testing::TestWithParam<Rounded> {
  protected:
    void expectQuotient(float a, float b) {
        spoilt_ += GetParam().ownQuotient(a, b) != a / b;
        wrong_ += floatBitsToUint(GetParam().quotient(a, b)) != floatBitsToUint(a / b);
        ++asked_;
    }
    void expectRoot(float x) {
        spoilt_ += GetParam().ownRoot(x) != std::sqrt(x);
        wrong_ += floatBitsToUint(GetParam().root(x)) != floatBitsToUint(std::sqrt(x));
        ++asked_;
    }
    void TearDown() override {
        EXPECT_EQ(wrong_, 0u) << "of " << asked_;
        EXPECT_GT(spoilt_, asked_ / 2) << "what was right from the beginning proves nothing";
    }

    std::uint32_t bits() { return static_cast<std::uint32_t>(numbers_()); }
    /// Of either sign where asked, its exponent within 2^±range.
    float number(int range, bool negative = true) {
        const std::uint32_t exponent =
            127u - static_cast<uint>(range) + bits() % (2 * static_cast<uint>(range));
        const std::uint32_t sign = negative ? bits() & 0x80000000u : 0u;
        return std::bit_cast<float>(sign | exponent << 23 | bits() >> 9);
    }

    std::mt19937 numbers_{7};
    std::uint64_t wrong_ = 0, spoilt_ = 0, asked_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Shaders, Exact,
                         testing::Values(Rounded{"ByFma", by_fma::quotient, by_fma::root, by_fma::ownQuotient,
                                                 by_fma::ownRoot},
                                         Rounded{"BySplitting", by_splitting::quotient, by_splitting::root,
                                                 by_splitting::ownQuotient, by_splitting::ownRoot}),
                         [](const auto& p) { return p.param.name; });

TEST_P(Exact, QuotientsOfAnySize) {
    const int count = test::sized(3'000'000, 100'000);
    for (int i = 0; i < count; ++i) expectQuotient(number(i % 2 ? 47 : 4), number(i % 2 ? 47 : 4));
    for (int i = 0; i < count / 8; ++i) expectQuotient(1.0f, number(47));
}

/// a = (M b - r) / 2^24 for the middle M between two quotients: as near to the middle as quotients get, on
/// both sides.
TEST_P(Exact, QuotientsNearTheMiddleOfTwoNumbers) {
    const int count = test::sized(2'000'000, 100'000);
    for (int i = 0; i < count; ++i) {
        const std::uint64_t b = (bits() >> 8) | 0x800001u;
        std::uint64_t inverse = b;  // modulo 2^24, by Newton's iteration
        for (int k = 0; k < 5; ++k) inverse *= 2 - b * inverse;
        const std::int64_t r = std::int64_t(bits() % 8) * 2 - 7;
        const std::uint64_t m = ((static_cast<std::uint64_t>(r) * inverse) & 0xffffffu) | 0x1000000u;
        const std::uint64_t a = (m * b - static_cast<std::uint64_t>(r)) >> 24;
        if (a > 0xffffffu && a % 2 != 0) continue;  // no float
        expectQuotient(static_cast<float>(a), static_cast<float>(b));
        expectQuotient(-static_cast<float>(a), std::ldexp(static_cast<float>(b), 13));
    }
}

TEST_P(Exact, RootsOfAnySize) {
    const int count = test::sized(3'000'000, 100'000);
    for (int i = 0; i < count; ++i) expectRoot(number(i % 2 ? 47 : 2, false));
}

/// Of the numbers next to the square of a middle between two roots, on both sides.
TEST_P(Exact, RootsNearTheMiddleOfTwoNumbers) {
    const int count = test::sized(1'000'000, 50'000);
    for (int i = 0; i < count; ++i) {
        const double middle = double((bits() >> 8) | 0x800000u) + 0.5;
        const float square = static_cast<float>(middle * middle);
        for (const float x : {square, std::nextafter(square, 0.0f), std::nextafter(square, 1e30f)}) {
            expectRoot(x);
            expectRoot(std::ldexp(x, -45));
        }
    }
}

/// Where nothing can be corrected, the driver's own stay as they are: 0, infinity, what is not a number.
TEST(ExactBeyondBounds, AreTheDriversOwn) {
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(by_fma::quotient(0, 3), 0);
    EXPECT_EQ(by_fma::quotient(1, 0), infinity);
    EXPECT_EQ(by_fma::quotient(1, infinity), 0);
    EXPECT_TRUE(std::isnan(by_fma::quotient(0, 0)));
    EXPECT_EQ(by_fma::root(0), 0);
    EXPECT_EQ(by_fma::root(infinity), infinity);
    EXPECT_TRUE(std::isnan(by_fma::root(-1)));
}

}  // namespace
}  // namespace scancast::gl
