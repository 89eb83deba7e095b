// Normal cones: conservative and nearly the smallest.
#include "renderer/cloud/normal_cone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using std::numbers::pi;

glm::vec3 direction(std::uint64_t i, std::uint64_t stream) {
    for (;; i += 1000003) {
        const glm::vec3 p = test::randomPoint(i, stream) * 2.0f - 1.0f;
        if (const float length = glm::length(p); length > 0.1f && length < 1) return p / length;
    }
}

/// Somewhere within `half` of the axis.
glm::vec3 near(const glm::vec3& axis, double half, std::uint64_t i) {
    const glm::dvec3 a(axis);
    const glm::dvec3 side = glm::normalize(glm::cross(a, glm::dvec3(direction(i, 11))));
    const double turn = half * std::sqrt(test::uniform(i, 77));
    return glm::vec3(glm::normalize(a * std::cos(turn) + side * std::sin(turn)));
}

double angle(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 p(a), q(b);
    return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

TEST(NormalCone, HoldsItsNormalsAndIsNotMuchWiderThanTheConeTheyWereDrawnFrom) {
    for (std::uint64_t n = 0; n < 300; ++n) {
        const double half = 0.001 + 1.4 * test::uniform(n, 5);
        const glm::vec3 axis = direction(n, 1);
        test::Points normals;
        for (std::uint64_t i = 0; i < 1 + n * n / 10; ++i)
            normals.push_back(near(axis, half, n * 100000 + i));
        const NormalCone cone = coneOf(normals);
        for (const glm::vec3& v : normals) ASSERT_LE(angle(cone.axis, v), cone.halfAngle) << n;
        EXPECT_LE(cone.halfAngle, half * 1.05 + 0.009) << n;
    }
}

TEST(NormalCone, OfNoneOrOfNoDirectionOrOfOppositesIsUnknown) {
    EXPECT_GE(double(coneOf({}).halfAngle), pi);
    EXPECT_GE(double(coneOf(test::Points{{0, 0, 1}, {0, 0, 0}}).halfAngle), pi);
    EXPECT_GE(double(coneOf(test::Points{{0, 0, 1}, {0, 0, -1}}).halfAngle), pi);
    EXPECT_GE(double(join({}).halfAngle), pi);
    EXPECT_GE(double(join(std::vector{NormalCone{{0, 0, 1}, 0.1f}, NormalCone{}}).halfAngle), pi);
}

TEST(NormalCone, JoinedHoldsWhateverItsPartsHold) {
    for (std::uint64_t n = 0; n < 2000; ++n) {
        std::vector<NormalCone> parts;
        for (std::uint64_t i = 0; i < 1 + n % 8; ++i)
            parts.push_back(
                {near(direction(n, 2), 0.5, n * 10 + i), float(0.3 * test::uniform(n * 10 + i, 3))});
        const NormalCone all = join(parts);
        ASSERT_LT(all.halfAngle, 1.8) << n;
        for (const NormalCone& part : parts)
            ASSERT_LE(angle(all.axis, part.axis) + part.halfAngle, all.halfAngle + 2e-6) << n;
    }
}

TEST(NormalCone, OfTwoIsTheSmallest) {
    // Right because a cone that touches both outer rims has half the angle between the rims.
    const NormalCone both = join(std::vector{NormalCone{{1, 0, 0}, 0.2f}, NormalCone{{0, 1, 0}, 0.4f}});
    EXPECT_NEAR(both.halfAngle, (pi / 2 + 0.6) / 2, 1e-5);
    const NormalCone inside =
        join(std::vector{NormalCone{{1, 0, 0}, 1.0f}, NormalCone{{std::cos(0.5f), std::sin(0.5f), 0}, 0.4f}});
    EXPECT_EQ(inside.halfAngle, 1.0f);
    const NormalCone opposite = join(std::vector{NormalCone{{1, 0, 0}, 0.1f}, NormalCone{{-1, 0, 0}, 0.1f}});
    EXPECT_NEAR(opposite.halfAngle, pi / 2 + 0.1, 1e-5);
}

}  // namespace
}  // namespace scancast
