#include "renderer/select/viewpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace scancast {
namespace {

const std::array<glm::dvec3, 2> unitBounds{glm::dvec3(-1), glm::dvec3(1)};

View lookingNorth(Projection projection = Projection::Perspective) {
    View view;
    view.width = 200;
    view.height = 100;
    view.camera.projection = projection;
    view.camera.eye = {0, -10, 0};
    view.camera.target = {0, 0, 0};
    view.camera.up = {0, 0, 1};
    view.camera.fov = 90;
    view.camera.viewHeight = 20;
    return view;
}

glm::dvec3 projected(const Viewpoint& v, const glm::dvec3& p) {
    return v.project(glm::dvec3(v.cloudToView * glm::dvec4(p, 1)));
}

TEST(Viewpoint, CentreRightAndUpLandWhereAPersonExpects) {
    // fov 90° → f = H/2 = 50 px, so at depth 10 one unit is 5 px; right on screen is east, up is up, row 0
    // the top.
    const auto v = *Viewpoint::create(lookingNorth(), glm::dvec3(0), unitBounds);
    EXPECT_EQ(projected(v, {0, 0, 0}), glm::dvec3(100, 50, 10));
    const auto east = projected(v, {1, 0, 0}), up = projected(v, {0, 0, 1});
    EXPECT_NEAR(east.x, 105, 1e-9);
    EXPECT_NEAR(east.y, 50, 1e-9);
    EXPECT_NEAR(up.x, 100, 1e-9);
    EXPECT_NEAR(up.y, 45, 1e-9);
}

TEST(Viewpoint, OrthographicSizeDoesNotDependOnDepth) {
    const auto v = *Viewpoint::create(lookingNorth(Projection::Orthographic), glm::dvec3(0), unitBounds);
    EXPECT_NEAR(projected(v, {1, 0, 0}).x, 105, 1e-9);
    EXPECT_NEAR(projected(v, {1, 50, 0}).x, 105, 1e-9);
    EXPECT_NEAR(v.q(1), 5, 1e-12);
    EXPECT_NEAR(v.q(1000), 5, 1e-12);
}

TEST(Viewpoint, AnOrthographicCameraInsideTheCloudSeesAllOfIt) {
    View view = lookingNorth(Projection::Orthographic);
    view.camera.eye = {0, 0.2, 0};
    view.camera.target = {0, 1, 0};
    const auto v = *Viewpoint::create(view, glm::dvec3(0), unitBounds);
    const auto behind = projected(v, {0, -1, 0});
    EXPECT_GT(behind.z, v.near);
    EXPECT_NEAR(behind.x, 100, 1e-9);
}

TEST(Viewpoint, LargeCoordinatesCostNoPrecision) {
    // The same scene at UTM coordinates: relative to its origin, pixels must agree to a millionth.
    const glm::dvec3 utm(4'500'000, 5'800'000, 300);
    View there = lookingNorth();
    there.camera.eye += utm;
    there.camera.target += utm;
    const auto near = *Viewpoint::create(lookingNorth(), glm::dvec3(0), unitBounds);
    const auto far = *Viewpoint::create(there, utm, {utm - 1.0, utm + 1.0});
    for (const glm::dvec3 p : {glm::dvec3(0.3, 0.1, -0.7), glm::dvec3(-1, 1, 1)}) {
        EXPECT_LT(glm::length(projected(near, p) - projected(far, p)), 1e-6);
    }
}

TEST(Viewpoint, AViewMatrixSaysTheSameAsEyeTargetUp) {
    const View view = lookingNorth();
    const glm::dvec3 origin(7, 8, 9);
    const auto byEye = *Viewpoint::create(view, glm::dvec3(0), unitBounds);
    View byMatrix = view;
    byMatrix.camera.viewMatrix.emplace();
    for (int i = 0; i < 16; ++i)
        (*byMatrix.camera.viewMatrix)[static_cast<std::size_t>(i)] = byEye.cloudToView[i / 4][i % 4];
    const auto a = *Viewpoint::create(view, origin, unitBounds);
    const auto b = *Viewpoint::create(byMatrix, origin, unitBounds);
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a.cloudToView[c][r], b.cloudToView[c][r], 1e-12);
    }
    EXPECT_LT(glm::length(a.eye() - (view.camera.eye - origin)), 1e-12);
}

TEST(Viewpoint, FrustumContainsExactlyWhatProjectsIntoThePicture) {
    for (const auto projection : {Projection::Perspective, Projection::Orthographic}) {
        View view = lookingNorth(projection);
        view.camera.near = 2;
        view.camera.far = 30;
        const auto v = *Viewpoint::create(view, glm::dvec3(0), unitBounds);
        const auto planes = v.frustum();
        int inside = 0;
        for (int i = 0; i < 20000; ++i) {
            // A scrambled lattice whose points lie on none of the planes.
            const glm::dvec3 p{i * 7919 % 1000 * 0.0801 - 40.003, i * 104729 % 997 * 0.0601 - 25.007,
                               i * 1299709LL % 991 * 0.0501 - 25.011};
            const auto pixel = projected(v, p);
            const bool visible =
                pixel.z > 2 && pixel.z < 30 && pixel.x > 0 && pixel.x < 200 && pixel.y > 0 && pixel.y < 100;
            bool contained = true;
            for (const auto& plane : planes) contained &= glm::dot(glm::dvec3(plane), p) + plane.w >= 0;
            ASSERT_EQ(visible, contained) << p.x << ' ' << p.y << ' ' << p.z;
            inside += visible;
        }
        EXPECT_GT(inside, 100);
    }
}

TEST(Viewpoint, NearBehindFarIsImpossible) {
    View view = lookingNorth();
    view.camera.far = 1e-12;
    const auto v = Viewpoint::create(view, glm::dvec3(0), unitBounds);
    ASSERT_FALSE(v);
    EXPECT_EQ(v.error().code, ErrorCode::ImpossibleView);
}

}  // namespace
}  // namespace scancast
