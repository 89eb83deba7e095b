#include "client/cpp/orbit_path.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace scancast::client {
namespace {

constexpr double tolerance = 1e-9;

Camera sample() {
    Camera camera;
    camera.eye = {5, -2, 7};
    camera.up = {0, 0, 1};
    return camera;
}

TEST(OrbitPath, AQuarterTurnIsCounterClockwise) {
    // (4, -3, 6) from the centre; by hand, (x, y) → (-y, x).
    const auto camera = orbitedCamera(sample(), {1, 1, 1}, {0, 0, 2}, 90);
    EXPECT_LT(glm::distance(camera.eye, glm::dvec3(1 + 3, 1 + 4, 7)), tolerance);
    EXPECT_EQ(camera.target, glm::dvec3(1, 1, 1));
    EXPECT_LT(glm::distance(camera.up, glm::dvec3(0, 0, 1)), tolerance);
}

TEST(OrbitPath, OtherAxesCanBeUp) {
    // (4, -3, 6) from the centre; a quarter turn around Y takes (x, z) → (z, -x).
    const auto camera = orbitedCamera(sample(), {1, 1, 1}, {0, 1, 0}, 90);
    EXPECT_LT(glm::distance(camera.eye, glm::dvec3(1 + 6, 1 - 3, 1 - 4)), tolerance);
}

TEST(OrbitPath, DistanceAndHeightStay) {
    const glm::dvec3 center(444000, 5412000, 100);
    const auto camera = sample();
    for (int degrees = 0; degrees < 720; degrees += 7) {
        const auto moved = orbitedCamera(camera, center, {0, 0, 1}, degrees);
        EXPECT_NEAR(glm::distance(moved.eye, center), glm::distance(camera.eye, center), 1e-6);
        EXPECT_NEAR(moved.eye.z, camera.eye.z, tolerance);
    }
}

TEST(OrbitPath, AViewFromAboveSpins) {
    Camera camera;
    camera.eye = {0, 0, 10};
    camera.up = {0, 1, 0};
    const auto moved = orbitedCamera(camera, {0, 0, 0}, {0, 0, 1}, 90);
    EXPECT_LT(glm::distance(moved.up, glm::dvec3(-1, 0, 0)), tolerance);
    View view;
    view.camera = moved;
    EXPECT_TRUE(validate(view));
}

TEST(OrbitPath, EverythingElseOfTheCameraStays) {
    auto camera = sample();
    camera.projection = Projection::Orthographic;
    camera.viewHeight = 3;
    camera.near = 0.5;
    auto expected = camera;
    expected.target = {1, 2, 3};
    EXPECT_EQ(orbitedCamera(camera, {1, 2, 3}, {0, 0, 1}, 0), expected);
}

}  // namespace
}  // namespace scancast::client
