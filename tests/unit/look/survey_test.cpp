// What is surveyed of a cloud, and what of that no picture need show.
#include "renderer/look/survey.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "tests/unit/look/scenes.hpp"

namespace scancast {
namespace {

using test::blob;
using test::pointAt;

TEST(WithoutStrays, WhatLiesFarFromEverythingIsLeftOut) {
    const auto scene = blob(5000, {10, 20, 30}, 5);
    auto points = scene;
    for (std::uint64_t i = 0; i < 20; ++i)
        points.push_back(pointAt(glm::dvec3(10, 20, 30) +
                                 blob(1000, {0, 0, 0}, 1)[i * 50].position * (200.0 + 900 * double(i))));
    // A flock of birds, dense, but small and a little off.
    test::append(points, blob(30, {22, 20, 30}, 0.2));
    for (std::uint64_t i = 0; i < 40; ++i) {
        points.push_back(pointAt(scene[i].position + glm::dvec3(0.001)));
        points.back().classification = i % 2 ? 7 : 18;
    }
    const auto kept = withoutStrays(points);
    EXPECT_EQ(kept.size(), scene.size());
    const auto box = boxOf(kept), wanted = boxOf(scene);
    EXPECT_EQ(box[0], wanted[0]);
    EXPECT_EQ(box[1], wanted[1]);
    EXPECT_TRUE(std::ranges::none_of(kept, [](const SurveyPoint& p) { return p.classification != 0; }));
}

TEST(WithoutStrays, TwoThingsOfOneSizeStay) {
    auto points = blob(2000, {0, 0, 0}, 1);
    test::append(points, blob(2000, {30, 0, 0}, 1));
    EXPECT_EQ(withoutStrays(points).size(), points.size());
}

TEST(WithoutStrays, WhereAllIsNoiseAllStays) {
    auto points = blob(1000, {0, 0, 0}, 1);
    for (SurveyPoint& p : points) p.classification = 7;
    EXPECT_EQ(withoutStrays(points).size(), points.size());
}

TEST(WithoutStrays, IsNeverEmpty) {
    for (const std::size_t count : {1, 2, 99, 100, 500}) {
        const std::vector<SurveyPoint> same(count, pointAt({5, 5, 5}));
        EXPECT_EQ(withoutStrays(same).size(), count);
        const auto line = test::surveyOf(count, [](auto i) {
            return pointAt({double(i), 2 * double(i), 1e15});
        });
        EXPECT_FALSE(withoutStrays(line).empty());
        // Each much farther away than all before it.
        const auto apart = test::surveyOf(count, [](auto i) {
            return pointAt({std::exp2(double(i % 60)), 0, 0});
        });
        EXPECT_FALSE(withoutStrays(apart).empty());
    }
}

TEST(QuantileOf, IsTheValueAtItsRank) {
    std::vector<double> values;
    for (int i = 100; i >= 0; --i) values.push_back(i * 0.5);
    EXPECT_EQ(quantileOf(values, 0), 0);
    EXPECT_EQ(quantileOf(values, 0.25), 12.5);
    EXPECT_EQ(quantileOf(values, 1), 50);
    EXPECT_EQ(quantileOf({7}, 0.99), 7);
}

TEST(Survey, IsAnEvenSampleOfAllOfTheCloud) {
    const auto cloud = test::sceneCloud("town", 60000);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const auto points = survey(**cloud, 5000);
    EXPECT_LE(points.size(), 2 * 5000U) << "a stride is whole";
    EXPECT_GT(points.size(), 2000U);
    const auto box = boxOf(points);
    const glm::dvec3 size = (*cloud)->bounds[1] - (*cloud)->bounds[0];
    for (int a = 0; a < 2; ++a) EXPECT_GT((box[1] - box[0])[a], 0.95 * size[a]);
    for (const SurveyPoint& p : points) {
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(p.position, (*cloud)->bounds[0] - 0.1)));
        EXPECT_TRUE(glm::all(glm::lessThanEqual(p.position, (*cloud)->bounds[1] + 0.1)));
        EXPECT_TRUE(p.normal == glm::vec3(0) || std::abs(glm::length(p.normal) - 1) < 0.02);
    }
    const auto again = survey(**cloud, 5000);
    ASSERT_EQ(again.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(again[i].position, points[i].position);
    EXPECT_TRUE(survey(Cloud{}, 100).empty());
}

// Oracle: the noise that the points were given, perpendicular to their plane.
TEST(NoiseOf, IsThatOfThePlane) {
    for (const double sigma : {0.0, 0.01, 0.05}) {
        const auto make = [&](std::uint64_t i, std::uint64_t) {
            double height = -6;
            for (std::uint64_t k = 0; k < 12; ++k) height += test::uniform(i, 10 + k);
            test::ScanPoint p;
            p.position = {20 * test::uniform(i, 1), 20 * test::uniform(i, 2), sigma * height};
            p.normal = {0, 0, 1};
            return p;
        };
        test::SyntheticSource source(20000, make, {.normal = true});
        BuildOptions build;
        build.shape.surfels = false;
        const auto cloud = buildCloud(source, build);
        ASSERT_TRUE(cloud) << cloud.error().message;
        EXPECT_NEAR(noiseOf(**cloud), sigma, 0.1 * sigma + 1e-6) << sigma;
    }
}

// A sphere's curvature is no noise: within its neighbours it bends by much more than the points are off it.
TEST(NoiseOf, IsThatOfASphere) {
    for (const double sigma : {0.0005, 0.005}) {
        const auto make = [&](std::uint64_t i, std::uint64_t) {
            double height = -6;
            for (std::uint64_t k = 0; k < 12; ++k) height += test::uniform(i, 10 + k);
            const double z = 2 * test::uniform(i, 1) - 1, turn = 6.283185307179586 * test::uniform(i, 2);
            const double r = std::sqrt(1 - z * z);
            test::ScanPoint p;
            p.position = glm::dvec3{r * std::cos(turn), r * std::sin(turn), z} * (1 + sigma * height);
            return p;
        };
        test::SyntheticSource source(5000, make, {});
        BuildOptions build;
        build.shape.surfels = false;
        const auto cloud = buildCloud(source, build);
        ASSERT_TRUE(cloud) << cloud.error().message;
        EXPECT_NEAR(noiseOf(**cloud), sigma, 0.15 * sigma) << sigma;
    }
}

}  // namespace
}  // namespace scancast
