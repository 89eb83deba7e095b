#include "client/cpp/program/view_control.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace scancast::client {
namespace {

Camera camera() {
    Camera camera;
    camera.eye = {0, -10, 0};
    camera.target = {0, 0, 0};
    return camera;
}

const glm::dvec3 z{0, 0, 1};

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-9) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(ViewControl, ADragOverTheHeightIsHalfATurn) {
    expectNear(orbited(camera(), z, 500, 0, 500).eye, {0, 10, 0});
    // Pulled to the right, the scene's right side goes away and the left comes: the eye walks to the left.
    expectNear(orbited(camera(), z, 250, 0, 500).eye, {-10, 0, 0});
    expectNear(orbited(camera(), z, 0, 125, 500).eye, {0, -10 * std::sqrt(0.5), 10 * std::sqrt(0.5)});
}

TEST(ViewControl, TurningKeepsTheDistanceAndNeverTipsOver) {
    auto turned = camera();
    for (int i = 0; i < 200; ++i) {
        turned = orbited(turned, z, 13, i < 100 ? 40 : -40, 500);
        View view;
        view.camera = turned;
        ASSERT_TRUE(validate(view)) << i;
        ASSERT_NEAR(glm::distance(turned.eye, turned.target), 10, 1e-9);
    }
    auto plan = camera();
    plan.eye = {0, 0, 10};
    plan.up = {0, 1, 0};
    View view;
    view.camera = orbited(plan, z, 10, -50, 500);
    EXPECT_TRUE(validate(view)) << "from straight above, too";
    EXPECT_LT(view.camera.eye.y, 0) << "what was up in the picture stays away from the viewer";
}

// Oracle: the pinhole camera; at the target's distance a px is 2 d tan(fov/2) / height wide.
TEST(ViewControl, WhatIsHeldStaysUnderThePointer) {
    const auto moved = panned(camera(), 50, 20, 500);
    const double unit = 2 * 10 * std::tan(std::acos(-1) / 6) / 500;
    expectNear(moved.target, {-50 * unit, 0, 20 * unit});
    expectNear(moved.eye - moved.target, camera().eye);
    auto flat = camera();
    flat.projection = Projection::Orthographic;
    flat.viewHeight = 25;
    expectNear(panned(flat, 500, 0, 500).target, {-25, 0, 0});
}

TEST(ViewControl, ZoomingAndFlying) {
    auto near = zoomed(camera(), 2);
    expectNear(near.eye, {0, -5, 0});
    EXPECT_EQ(near.viewHeight, camera().viewHeight / 2);
    const auto flown_ = flown(camera(), 0.5, 0.25, 0.1);
    expectNear(flown_.eye, {2.5, -5, 1});
    expectNear(flown_.target, {2.5, 5, 1});
}

}  // namespace
}  // namespace scancast::client
