#include "renderer/cloud/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

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

/// docs/spec/hierarchy.md §5, a number after the other.
glm::vec3 unfolded(std::uint16_t code) {
    const float u = float((code >> 8) - 128) / 127.0f, v = float((code & 255) - 128) / 127.0f;
    const auto sign = [](float c) { return c < 0 ? -1.0f : 1.0f; };
    glm::vec3 n(u, v, 1 - std::abs(u) - std::abs(v));
    if (n.z < 0) n = {(1 - std::abs(v)) * sign(u), (1 - std::abs(u)) * sign(v), n.z};
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return {n.x / length, n.y / length, n.z / length};
}

TEST(NormalCodec, DecodesEveryCodeAsTheFormulaSays) {
    for (int code = 1; code < 65536; ++code)
        ASSERT_EQ(decodeNormal(std::uint16_t(code)), unfolded(std::uint16_t(code))) << code;
}

TEST(NormalCodec, NoCodeIsNearer) {
    std::vector<glm::vec3> decoded;
    for (int u = 1; u < 256; ++u)
        for (int v = 1; v < 256; ++v) decoded.push_back(unfolded(std::uint16_t(u << 8 | v)));
    for (std::uint64_t i = 0; i < 300; ++i) {
        const glm::vec3 n = test::ball(i, 0).normal;
        float nearest = -1;
        for (const glm::vec3& d : decoded) nearest = std::max(nearest, glm::dot(d, n));
        ASSERT_GE(glm::dot(decodeNormal(encodeNormal(n)), n), nearest - 1e-6f) << i;
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
