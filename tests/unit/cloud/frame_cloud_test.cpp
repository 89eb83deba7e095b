// Clouds of live frames: octrees as any other, with surfaces estimated by cells.
#include "renderer/cloud/build/frame/frame_cloud.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "renderer/cloud/build/frame/frame_order.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "tests/support/clouds/octree_checks.hpp"

namespace scancast::test {
namespace {

PointFrame frameOf(std::vector<glm::dvec3> positions) {
    PointFrame frame;
    frame.header.format = "test";
    frame.points.position = std::move(positions);
    return frame;
}

double unit(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

/// Evenly scattered over a sphere of radius 1.
PointFrame sphereFrame(std::size_t count, const glm::dvec3& middle = glm::dvec3(0)) {
    std::mt19937 random(3);
    std::vector<glm::dvec3> positions;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 2 * unit(random) - 1, angle = 2 * std::numbers::pi * unit(random);
        const double r = std::sqrt(1 - z * z);
        positions.push_back(middle + glm::dvec3(r * std::cos(angle), r * std::sin(angle), z));
    }
    return frameOf(std::move(positions));
}

std::shared_ptr<const Cloud> cloudOf(const PointFrame& frame, FrameOptions options = {}) {
    auto cloud = buildFrameCloud(frame, options);
    EXPECT_TRUE(cloud) << cloud.error().message;
    return cloud ? *cloud : nullptr;
}

TEST(FrameCloud, EveryPointIsInALeafOnce) {
    for (const std::size_t count : {1UL, 2UL, 7UL, 16384UL, 16385UL, 60'000UL}) {
        const PointFrame frame = sphereFrame(count, {389'500, 5'819'800, 34});
        const auto cloud = cloudOf(frame);
        ASSERT_TRUE(cloud);
        checkStructure(*cloud, 16384);
        checkBounds(cloud->octree);
        checkEachPointOnce(*cloud, {frame.points.position.begin(), frame.points.position.end()}, 1e-4);
    }
}

TEST(FrameCloud, TheSameFrameGivesTheSameCloudOnAnyNumberOfThreads) {
    const PointFrame frame = sphereFrame(100'000);
    const auto one = cloudOf(frame, {.threads = 1}), many = cloudOf(frame, {.threads = 5});
    EXPECT_EQ(one->revision, many->revision);
    PointFrame other = frame;
    other.points.position.doubles().back().z += 0.01;
    EXPECT_NE(cloudOf(other)->revision, one->revision);
}

// A sphere's normal at a point is the way there from its middle, and n points on it share 4π.
TEST(FrameCloud, NormalsAndRadiiAreThoseOfTheSurface) {
    constexpr std::size_t count = 50'000;
    const auto cloud = cloudOf(sphereFrame(count));
    const double pitch = std::sqrt(4 * std::numbers::pi / count);
    EXPECT_NEAR(cloud->spacing, pitch, 0.15 * pitch);
    std::size_t wrong = 0, all = 0;
    double radii = 0;
    for (const Node& n : cloud->octree.nodes()) {
        if (!n.isLeaf()) continue;
        for (const Sample& s : samples(cloud->octree, n)) {
            const glm::dvec3 out = glm::normalize(position(n, s) + cloud->origin);
            const Surfel surfel = decodeSurfel(s, n.radiusUnit);
            wrong +=
                std::abs(glm::dot(glm::dvec3(surfel.normal), out)) < std::cos(8 * std::numbers::pi / 180);
            radii += surfel.radius;
            ++all;
        }
    }
    EXPECT_EQ(all, count);
    EXPECT_LE(wrong, count / 100);
    EXPECT_NEAR(radii / double(all), 1.35 * pitch, 0.2 * pitch);
    EXPECT_TRUE(cloud->surfels);
    EXPECT_FALSE(cloud->oriented) << "nobody said where it was seen from";
}

TEST(FrameCloud, NormalsPointToTheScannerThatTheFrameNames) {
    PointFrame frame = sphereFrame(20'000, {100, 200, 300});
    frame.header.scannerOrigin = {100, 200, 300};  // in the middle: all of them point inwards
    const auto cloud = cloudOf(frame);
    EXPECT_TRUE(cloud->oriented);
    for (const Node& n : cloud->octree.nodes())
        for (const Sample& s : samples(cloud->octree, n)) {
            const glm::dvec3 in = glm::dvec3(100, 200, 300) - (position(n, s) + cloud->origin);
            EXPECT_GT(glm::dot(glm::dvec3(decodeNormal(s.normal)), in), 0);
        }
}

// Where a scan has dense and sparse parts, each has its own spacing.
TEST(FrameCloud, DensityMayDiffer) {
    std::mt19937 random(5);
    std::vector<glm::dvec3> positions;
    for (int i = 0; i < 40'000; ++i) positions.emplace_back(unit(random), unit(random), 0);
    for (int i = 0; i < 2'500; ++i) positions.emplace_back(2 + unit(random), unit(random), 0);
    const auto cloud = cloudOf(frameOf(positions));
    std::array<double, 2> radii{};
    std::array<int, 2> counts{};
    for (const Node& n : cloud->octree.nodes()) {
        if (!n.isLeaf()) continue;
        for (const Sample& s : samples(cloud->octree, n)) {
            const std::size_t sparse = (position(n, s) + cloud->origin).x > 1.5;
            radii[sparse] += decodeSurfel(s, n.radiusUnit).radius;
            ++counts[sparse];
        }
    }
    EXPECT_NEAR(radii[0] / counts[0], 1.35 / 200, 0.2 / 200);
    EXPECT_NEAR(radii[1] / counts[1], 1.35 / 50, 0.3 / 50);
}

TEST(FrameCloud, WhatTheFirstFrameDecidedStays) {
    PointFrame first = sphereFrame(1000), second = sphereFrame(2000, {5, 0, 0});
    for (PointFrame* frame : {&first, &second}) {
        frame->header.attributes.intensity = true;
        frame->points.intensity.assign(frame->points.size(), frame == &first ? 100 : 200);
    }
    first.points.intensity[0] = 90;
    const auto before = cloudOf(first);
    FrameBasis basis = basisOf(*before);
    basis.look.emplace().reason = "decided";
    const auto after = cloudOf(second, {.basis = &basis});
    EXPECT_EQ(after->origin, before->origin);
    EXPECT_EQ(after->intensityRange, before->intensityRange);
    EXPECT_EQ(after->usual, before->usual);
    ASSERT_TRUE(after->look);
    EXPECT_EQ(after->look->reason, "decided");
    EXPECT_TRUE(after->attributes.intensity) << "alike in one frame is not alike for ever";
    EXPECT_EQ(after->points, 2000U);
    EXPECT_NEAR(after->bounds[0].x, 4, 0.1);
}

TEST(FrameCloud, PointsThatNoCellTellsApart) {
    const auto cloud = cloudOf(frameOf(std::vector<glm::dvec3>(300'000, glm::dvec3(1, 2, 3))));
    checkStructure(*cloud, 16384);
    EXPECT_EQ(cloud->octree.node(0).points, 300'000U);
}

TEST(FrameCloud, AStrayPointFarAwayChangesNothingElse) {
    PointFrame frame = sphereFrame(30'000);
    frame.points.position.emplace_back(2000, 0, 0);
    const auto cloud = cloudOf(frame);
    const double pitch = std::sqrt(4 * std::numbers::pi / 30'000);
    EXPECT_NEAR(cloud->spacing, pitch, 0.2 * pitch);
    checkBounds(cloud->octree);
}

TEST(FrameCloud, WithoutSurfels) {
    const auto cloud = cloudOf(sphereFrame(1000), {.surfels = false});
    EXPECT_FALSE(cloud->surfels);
    EXPECT_FALSE(cloud->attributes.normal);
    EXPECT_EQ(samples(cloud->octree, cloud->octree.node(0))[0].logRadius, noRadius);
}

TEST(FrameCloud, WhatIsNoFrameIsRefused) {
    EXPECT_EQ(buildFrameCloud(frameOf({}), {}).error().code, ErrorCode::Empty);
    EXPECT_EQ(buildFrameCloud(frameOf({{0, 0, 0}, {1e16, 0, 0}}), {}).error().code, ErrorCode::Malformed);
}

TEST(FrameOrder, KeysAndCells) {
    for (const std::array<std::uint32_t, 3> cell :
         {std::array<std::uint32_t, 3>{0, 0, 0}, {1, 2, 3}, {2097151, 0, 2097151}, {1234567, 7, 89}})
        EXPECT_EQ(cellOfKey(frameKey(cell)), cell);
    EXPECT_EQ(commonLevel(5, 5), 0);
    EXPECT_EQ(commonLevel(0, 7), 1);
    EXPECT_EQ(commonLevel(0, 8), 2);
    PointBatch points;
    points.position.doubles() = {{0, 0, 0}, {1, 0, 0}, {0.9, 0, 0}, {0, 0, 0}};
    const FrameOrder order = orderFrame(points, {glm::dvec3(0), glm::dvec3(1, 0, 0)}, glm::dvec3(0));
    const auto counts = order.cellCounts(0, 4);
    EXPECT_EQ(counts[0], 3U);
    EXPECT_EQ(counts[20], 2U);
    EXPECT_EQ(counts[21], 1U);
}

}  // namespace
}  // namespace scancast::test
