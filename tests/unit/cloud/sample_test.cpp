#include "renderer/cloud/sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

double degreesBetween(glm::dvec3 a, glm::dvec3 b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 57.29577951308232;
}

TEST(NormalCodec, ErrsByLessThanItPromises) {
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        const glm::vec3 n = test::ball(i, 0).normal;
        const std::uint16_t code = encodeNormal(n);
        ASSERT_NE(code, noNormal);
        ASSERT_LE(degreesBetween(n, decodeNormal(code)), 0.95);
    }
}

TEST(NormalCodec, KeepsTheAxesExactly) {
    for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
        EXPECT_EQ(decodeNormal(encodeNormal(axis)), axis);
        EXPECT_EQ(decodeNormal(encodeNormal(-axis)), -axis);
    }
}

TEST(NormalCodec, EveryDecodedNormalIsUnitAndComesBack) {
    for (int u = 1; u < 256; ++u)
        for (int v = 1; v < 256; ++v) {
            const glm::vec3 n = decodeNormal(std::uint16_t(u << 8 | v));
            ASSERT_NEAR(glm::length(n), 1, 1e-6);
            ASSERT_LE(degreesBetween(n, decodeNormal(encodeNormal(n))), 0.02);
        }
}

TEST(NormalCodec, NoNormalIsZeroAndBack) {
    EXPECT_EQ(decodeNormal(noNormal), glm::vec3(0));
    EXPECT_EQ(encodeNormal(glm::vec3(0)), noNormal);
    EXPECT_EQ(encodeNormal(glm::vec3(NAN, 0, 1)), noNormal);
}

TEST(NormalCodec, LengthDoesNotMatter) {
    const glm::vec3 n(0.3f, -0.7f, -0.2f);
    EXPECT_EQ(encodeNormal(n), encodeNormal(n * 1000.0f));
}

}  // namespace
}  // namespace scancast
