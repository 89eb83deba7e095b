#include "renderer/residency/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace scancast {
namespace {

Camera camera(glm::dvec3 eye, glm::dvec3 target) {
    Camera c;
    c.eye = eye;
    c.target = target;
    return c;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
    EXPECT_LT(glm::length(a - b), tolerance) << a.x << ", " << a.y << ", " << a.z;
}

TEST(Motion, AnOrbitGoesOnAlongItsCircle) {
    const auto at = [](double angle) {
        return camera({100 + 20 * std::cos(angle), 50 + 20 * std::sin(angle), 7}, {100, 50, 7});
    };
    const auto next = extrapolate(at(0.3), at(0.35), 0.1, 0.4);
    ASSERT_TRUE(next);
    expectNear(next->eye, at(0.55).eye);
    expectNear(next->target, at(0.55).target);
}

TEST(Motion, AWalkGoesStraightOn) {
    const auto next = extrapolate(camera({0, 0, 2}, {0, 10, 2}), camera({0, 1, 2}, {0, 11, 2}), 0.1, 0.3);
    ASSERT_TRUE(next);
    expectNear(next->eye, {0, 4, 2});
    expectNear(next->target, {0, 14, 2});
}

TEST(Motion, WhoTurnsRoundKeepsTheirPlace) {
    const auto at = [](double angle) {
        return camera({5, 6, 7}, {5 + 3 * std::cos(angle), 6 + 3 * std::sin(angle), 7});
    };
    const auto next = extrapolate(at(1.0), at(1.1), 0.1, 0.2);
    ASSERT_TRUE(next);
    expectNear(next->eye, {5, 6, 7});
    expectNear(next->target, at(1.3).target);
}

TEST(Motion, ZoomingInNeverPassesTheTarget) {
    const auto next = extrapolate(camera({0, 0, 8}, {}), camera({0, 0, 4}, {}), 0.1, 0.3);
    ASSERT_TRUE(next);
    expectNear(next->eye, {0, 0, 0.5});
}

TEST(Motion, NoMotionNoGuess) {
    const Camera still = camera({1, 2, 3}, {});
    EXPECT_FALSE(extrapolate(still, still, 0.1, 0.3));
    const Camera moved = camera({1, 2, 4}, {});
    EXPECT_FALSE(extrapolate(still, moved, 0, 0.3));
    EXPECT_FALSE(extrapolate(still, moved, 3, 0.3)) << "two looks, not one movement";
    EXPECT_FALSE(extrapolate(camera({}, {}), moved, 0.1, 0.3)) << "no direction to turn";
    Camera other = moved;
    other.projection = Projection::Orthographic;
    EXPECT_FALSE(extrapolate(still, other, 0.1, 0.3));
    Camera matrix = moved;
    matrix.viewMatrix.emplace();
    EXPECT_FALSE(extrapolate(still, matrix, 0.1, 0.3));
}

}  // namespace
}  // namespace scancast
