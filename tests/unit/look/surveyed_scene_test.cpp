// Which kind of scene a survey shows, and which way is up, of scenes that were made to be one.
#include "renderer/look/surveyed_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

#include "tests/unit/look/scenes.hpp"

namespace scancast {
namespace {

using test::between;
using test::factsOf;
using test::pointAt;

SurveyedScene sceneOf(const std::vector<SurveyPoint>& points, const std::string& format) {
    return sceneOf(factsOf(points, format), points);
}

void expectDepthFrame(double sign) {
    const SurveyedScene scene = sceneOf(test::depthFrame(8000, sign), "PLY");
    EXPECT_EQ(scene.kind, SceneKind::DepthFrame) << scene.reason;
    EXPECT_EQ(scene.forward, glm::dvec3(0, 0, sign));
    EXPECT_EQ(scene.up, glm::dvec3(0, -sign, 0)) << "cameras' rows count down along +z";
    EXPECT_EQ(scene.sensor, glm::dvec3(0));
}

TEST(SceneOf, WhatACameraSawAlongEitherAxis) {
    expectDepthFrame(1);
    expectDepthFrame(-1);
}

TEST(SceneOf, ALandscapeOfItsOwnCoordinatesIsNoDepthFrame) {
    const auto tile = test::landscape(10000, {-500, -500}, 200, 230);
    for (const char* format : {"PLY", "PCD", "LAS 1.2"}) {
        const SurveyedScene scene = sceneOf(tile, format);
        EXPECT_NE(scene.kind, SceneKind::DepthFrame) << format;
        EXPECT_EQ(scene.up, glm::dvec3(0, 0, 1)) << format << scene.reason;
    }
    const SurveyedScene survey = sceneOf(tile, "LAS 1.2, point format 3");
    EXPECT_EQ(survey.kind, SceneKind::Airborne) << survey.reason;
    EXPECT_FALSE(survey.onlyFromAbove);
}

TEST(SceneOf, AThingSeenFromAllSidesAboveTheOriginIsNoDepthFrame) {
    const SurveyedScene scene = sceneOf(test::blob(8000, {0, 0, 3}, 1), "PLY");
    EXPECT_EQ(scene.kind, SceneKind::Object) << scene.reason;
}

/// A cone that stands on its base: up is where its tip is.
std::vector<SurveyPoint> cone(const glm::dvec3& up) {
    const auto axes = horizontalAxes(up);
    return test::surveyOf(9000, [&](std::uint64_t i) {
        const double turn = between(0, 6.283185307179586, i, 1);
        const bool base = i % 3 == 0;
        const double height = base ? 0 : 1 - std::sqrt(between(0, 1, i, 2));
        const double radius = base ? std::sqrt(between(0, 1, i, 2)) : 1 - height;
        const glm::dvec3 out = std::cos(turn) * axes[0] + std::sin(turn) * axes[1];
        const glm::dvec3 normal = base ? -up : glm::normalize(out + up);
        return pointAt(radius * out + 1.5 * height * up, glm::vec3(normal));
    });
}

TEST(SceneOf, ModelsStandOnTheirBroadSide) {
    for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0)}) {
        const SurveyedScene scene = sceneOf(cone(up), "PLY");
        EXPECT_EQ(scene.up, up) << scene.reason;
        EXPECT_EQ(scene.kind, SceneKind::Object) << scene.reason;
    }
    // In a survey z is up, however it stands.
    EXPECT_EQ(sceneOf(cone({0, 1, 0}), "LAS 1.4, point format 7").up, glm::dvec3(0, 0, 1));
}

TEST(SceneOf, DegreesAreSeenFromAboveOnly) {
    auto points = test::landscape(5000, {0, 0}, 100, 900);
    for (SurveyPoint& p : points)
        p.position = {11 + p.position.x * 1e-5, 48 + p.position.y * 1e-5, p.position.z};
    CloudFacts facts = factsOf(points, "LAS 1.4");
    facts.crsEpsg = 4326;
    const SurveyedScene scene = sceneOf(facts, points);
    EXPECT_TRUE(scene.onlyFromAbove);
    EXPECT_EQ(scene.kind, SceneKind::Airborne);
    EXPECT_EQ(scene.up, glm::dvec3(0, 0, 1));
    facts.crsEpsg = 25832;
    EXPECT_FALSE(sceneOf(facts, points).onlyFromAbove);
}

/// The floor, ceiling and walls of a room of 8 × 6 × 2.8, seen from inside; a table in it.
std::vector<SurveyPoint> room() {
    return test::surveyOf(12000, [](std::uint64_t i) {
        const double x = between(0, 8, i, 1), y = between(0, 6, i, 2), z = between(0, 2.8, i, 3);
        switch (i % 8) {
            case 0:
            case 1:
                return pointAt({x, y, 0}, {0, 0, 1});
            case 2:
            case 3:
                return pointAt({x, y, 2.8}, {0, 0, -1});
            case 4:
                return pointAt({x, i % 16 < 8 ? 0 : 6, z}, {0, 1, 0});
            case 5:
                return pointAt({i % 16 < 8 ? 0 : 8, y, z}, {1, 0, 0});
            default:
                return pointAt({3 + x / 4, 2 + y / 3, 0.8}, {0, 0, 1});
        }
    });
}

TEST(SceneOf, ARoomHasFloorAndCeiling) {
    const SurveyedScene scene = sceneOf(room(), "PLY");
    EXPECT_EQ(scene.kind, SceneKind::Indoor) << scene.reason;
    EXPECT_EQ(scene.up, glm::dvec3(0, 0, 1));
    // The same with y up.
    auto turned = room();
    for (SurveyPoint& p : turned) {
        p.position = {p.position.x, p.position.z, -p.position.y};
        p.normal = {p.normal.x, p.normal.z, -p.normal.y};
    }
    const SurveyedScene other = sceneOf(turned, "PLY");
    EXPECT_EQ(other.kind, SceneKind::Indoor) << other.reason;
    EXPECT_EQ(other.up, glm::dvec3(0, 1, 0)) << other.reason;
}

TEST(SceneOf, WhereTheScannerStoodIsKept) {
    const auto points = room();
    CloudFacts facts = factsOf(points, "PTX");
    facts.scanner = {4, 3, 1.5};
    EXPECT_EQ(sceneOf(facts, points).sensor, facts.scanner);
}

struct Generated {
    const char* scene;
    std::vector<SceneKind> kinds;  ///< that it may be taken for
    bool standsUpright;            ///< it tells which way is up
};

class GeneratedScene : public ::testing::TestWithParam<Generated> {};

TEST_P(GeneratedScene, IsOfItsKindAndStandsAsItWasMade) {
    const auto cloud = test::sceneCloud(GetParam().scene, 40000);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const SurveyedScene scene = sceneOf(**cloud, survey(**cloud, 12000));
    EXPECT_NE(std::ranges::find(GetParam().kinds, scene.kind), GetParam().kinds.end())
        << name(scene.kind) << scene.reason;
    EXPECT_TRUE(!GetParam().standsUpright || scene.up == glm::dvec3(0, 0, 1)) << scene.reason;
    EXPECT_FALSE(scene.onlyFromAbove);
    EXPECT_GT(scene.extent(), 0);
}

INSTANTIATE_TEST_SUITE_P(Simulator, GeneratedScene,
                         testing::Values(Generated{"town", {SceneKind::Airborne, SceneKind::Street}, true},
                                         Generated{"room", {SceneKind::Indoor}, true},
                                         Generated{"cube", {SceneKind::Object}, false},
                                         Generated{"sphere", {SceneKind::Object}, false}),
                         [](const auto& tested) { return std::string(tested.param.scene); });

TEST(SceneOf, AnyPointsAreAScene) {
    for (const std::uint64_t count : {1, 2, 3, 50, 200, 1000}) {
        for (const double size : {0.0, 1e-12, 1.0, 1e15}) {
            const std::vector<std::vector<SurveyPoint>> shapes{
                test::surveyOf(count,
                               [=](auto i) {
                                   return pointAt({size * double(i), 0, 0});
                               }),
                test::surveyOf(count,
                               [=](auto i) {
                                   return pointAt({0, 0, size * double(i)}, {0, 0, 1});
                               }),
                test::surveyOf(count,
                               [=](auto i) {
                                   return pointAt({size, size * test::uniform(i, 1), -size});
                               }),
                test::surveyOf(count, [=](auto i) {
                    return pointAt(size *
                                   glm::dvec3(test::uniform(i, 1), test::uniform(i, 2), test::uniform(i, 3)));
                })};
            for (const auto& points : shapes)
                for (const char* format : {"PLY", "LAS 1.2"}) {
                    const SurveyedScene scene = sceneOf(points, format);
                    EXPECT_NEAR(glm::length(scene.up), 1, 1e-9);
                    EXPECT_GT(scene.extent(), 0);
                    EXPECT_FALSE(scene.points.empty());
                    EXPECT_FALSE(scene.reason.empty());
                }
        }
    }
}

TEST(HorizontalAxes, AreRightHanded) {
    for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0),
                                glm::dvec3(1, 0, 0), glm::normalize(glm::dvec3(1, 2, 3))}) {
        const auto [first, second] = horizontalAxes(up);
        EXPECT_NEAR(glm::distance(glm::cross(first, second), up), 0, 1e-12);
        EXPECT_NEAR(glm::length(first), 1, 1e-12);
    }
}

}  // namespace
}  // namespace scancast
