// Shapes of known size out of noisy points, half of them something else: robust means that these are found all the same.
#include "renderer/measure/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "renderer/measure/shapes.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

double noise(std::uint64_t i, std::uint64_t stream) {
    const double u = uniform(i, stream), v = uniform(i, stream + 100);
    return std::sqrt(-2 * std::log(1 - u)) * std::cos(2 * std::numbers::pi * v);
}

struct Tube {
    glm::dvec3 center{0.3, -0.2, 0.1}, axis = glm::normalize(glm::dvec3(0.3, 0.5, 0.8));
    double radius = 0.15, length = 0.8, arc = 2 * std::numbers::pi, sigma = 0.002;
};

std::vector<glm::dvec3> tubePoints(const Tube& tube, std::size_t count, double strays) {
    const auto [u, v] = across(tube.axis);
    std::vector<glm::dvec3> points;
    for (std::uint64_t i = 0; i < count; ++i) {
        if (uniform(i, 9) < strays) {
            points.push_back(tube.center +
                             glm::dvec3(uniform(i, 1) - 0.5, uniform(i, 2) - 0.5, uniform(i, 3) - 0.5));
            continue;
        }
        const double turn = tube.arc * uniform(i, 4), r = tube.radius + tube.sigma * noise(i, 5);
        points.push_back(tube.center + tube.length * (uniform(i, 6) - 0.5) * tube.axis +
                         r * (std::cos(turn) * u + std::sin(turn) * v));
    }
    return points;
}

MeasureRequest requestOf(MeasureKind kind) {
    MeasureRequest request;
    request.kind = kind;
    request.points = {glm::dvec3(0)};
    request.within = 1;
    return request;
}

TEST(Fit, CylindersAreFoundAmongStrays) {
    for (const double arc : {2 * std::numbers::pi, 2.5}) {
        Tube tube;
        tube.arc = arc;
        const auto shape =
            fitShape(requestOf(MeasureKind::Cylinder), tubePoints(tube, sized(4000, 1500), 0.25), 1e-6);
        ASSERT_TRUE(shape) << shape.error().message;
        EXPECT_NEAR(shape->radius, tube.radius, 0.001);
        EXPECT_GT(std::abs(glm::dot(shape->axis, tube.axis)), std::cos(0.01));
        EXPECT_NEAR(shape->rms, tube.sigma, 0.3 * tube.sigma);
        EXPECT_NEAR(shape->arc, arc * 180 / std::numbers::pi, 25);
        const glm::dvec3 off = shape->center - tube.center;
        EXPECT_LT(glm::length(off - glm::dot(off, tube.axis) * tube.axis), 0.002);
        EXPECT_GT(shape->axis.z, 0) << "upwards";
    }
}

TEST(Fit, AStemIsACircleSeenFromAbove) {
    Tube stem;
    stem.axis = {0, 0, 1};
    const auto shape = fitShape(requestOf(MeasureKind::Circle), tubePoints(stem, 2000, 0.3), 1e-6);
    ASSERT_TRUE(shape) << shape.error().message;
    EXPECT_NEAR(shape->radius, stem.radius, 0.0005);
    EXPECT_NEAR(shape->center.x, stem.center.x, 0.0005);
    EXPECT_EQ(shape->length, 0);
}

TEST(Fit, BallsAndPlanes) {
    std::vector<glm::dvec3> ball, wall;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, 0.5));
    const auto [u, v] = across(normal);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const glm::dvec3 stray(uniform(i, 1), uniform(i, 2), uniform(i, 3));
        const glm::dvec3 out = glm::normalize(glm::dvec3(noise(i, 11), noise(i, 12), std::abs(noise(i, 13))));
        ball.push_back(i % 4 == 0 ? stray : glm::dvec3(0.5) + (0.3 + 0.001 * noise(i, 14)) * out);
        wall.push_back(i % 3 == 0 ? stray
                                  : 0.4 * normal + uniform(i, 4) * u + uniform(i, 5) * v +
                                        0.001 * noise(i, 6) * normal);
    }
    const auto sphere = fitShape(requestOf(MeasureKind::Sphere), ball, 1e-6);
    ASSERT_TRUE(sphere) << sphere.error().message;
    EXPECT_NEAR(sphere->radius, 0.3, 0.0005);
    EXPECT_LT(glm::distance(sphere->center, glm::dvec3(0.5)), 0.001);
    const auto plane = fitShape(requestOf(MeasureKind::Plane), wall, 1e-6);
    ASSERT_TRUE(plane) << plane.error().message;
    EXPECT_GT(std::abs(glm::dot(plane->axis, normal)), std::cos(0.003));
    EXPECT_NEAR(glm::dot(plane->center, normal), 0.4, 0.0005);
}

TEST(Fit, TooFewAndPointsOfNothingAreSaid) {
    const auto none = fitShape(requestOf(MeasureKind::Cylinder), {}, 1e-6);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::Empty);
    const auto line =
        fitShape(requestOf(MeasureKind::Sphere), std::vector<glm::dvec3>(20, glm::dvec3(1)), 1e-6);
    ASSERT_FALSE(line);
    EXPECT_EQ(line.error().code, ErrorCode::Empty);
}

TEST(Fit, ThreePickedPointsAreACircleThroughThem) {
    MeasureRequest request;
    request.kind = MeasureKind::Circle;
    const glm::dvec3 far(389400, 5819700, 34);
    request.points = {far + glm::dvec3(5, 0, 0), far + glm::dvec3(0, 5, 0), far + glm::dvec3(0, -5, 0)};
    const auto circle = measureShape(Cloud(), {}, request);
    ASSERT_TRUE(circle) << circle.error().message;
    EXPECT_NEAR(circle->radius, 5, 1e-9);
    EXPECT_LT(glm::distance(circle->center, far), 1e-8);
    EXPECT_NEAR(circle->axis.z, 1, 1e-9);
    request.points[2] = far + glm::dvec3(10, -5, 0);
    EXPECT_EQ(measureShape(Cloud(), {}, request).error().field, "points") << "on one line";
}

}  // namespace
}  // namespace scancast::test
