// What a cloud says about itself, and how building one fails.
#include "renderer/cloud/cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;

class FailingSource : public PointSource {
  public:
    FailingSource(int goodBatches, glm::dvec3 at) : left_(goodBatches), at_(at) {}
    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 7; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        if (left_-- == 0) return fail(ErrorCode::Truncated, "scan.las ends at byte 100.");
        batch.position.doubles().assign(10, at_);
        batch.color = colors;
        return true;
    }
    std::vector<std::array<std::uint8_t, 3>> colors;

  private:
    ScanHeader header_;
    int left_;
    glm::dvec3 at_;
};

TEST(BuildCloud, PassesOnTheSourcesError) {
    for (const int batches : {0, 1, 5}) {
        FailingSource source(batches, glm::dvec3(1));
        const auto cloud = buildCloud(source, {});
        ASSERT_FALSE(cloud);
        EXPECT_EQ(cloud.error().code, ErrorCode::Truncated);
        EXPECT_EQ(cloud.error().message, "scan.las ends at byte 100.");
    }
}

TEST(BuildCloud, RefusesCoordinatesThatNoScanHas) {
    for (const double bad : {1e16, -1e300, double(NAN), double(INFINITY)}) {
        FailingSource source(3, glm::dvec3(0, bad, 0));
        const auto cloud = buildCloud(source, {});
        ASSERT_FALSE(cloud);
        EXPECT_EQ(cloud.error().code, ErrorCode::Malformed) << bad;
    }
}

TEST(BuildCloud, RefusesColumnsOfDifferentLengths) {
    FailingSource source(3, glm::dvec3(0));
    source.colors.resize(9);
    const auto cloud = buildCloud(source, {});
    ASSERT_FALSE(cloud);
    EXPECT_EQ(cloud.error().code, ErrorCode::Internal);
}

/// The cloud of `points` points on a line, of which only the last has `last`; the others have `all`.
std::shared_ptr<const Cloud> cloudOf(std::uint64_t points, ScanPoint all, ScanPoint last,
                                     Attributes has = {.color = true, .intensity = true}) {
    SyntheticSource source(
        points,
        [=](std::uint64_t i, std::uint64_t n) {
            ScanPoint p = i + 1 < n ? all : last;
            p.position = {double(i), 0, 0};
            return p;
        },
        has);
    const auto cloud = buildCloud(source, {});
    EXPECT_TRUE(cloud) << cloud.error().message;
    return *cloud;
}

// Over the border of a batch: what the last point alone has is known at the end of the scan only.
TEST(BuildCloud, WhatIsTheSameEverywhereIsNoAttribute) {
    const ScanPoint black{.color = {0, 0, 0}, .intensity = 0}, red{.color = {255, 0, 0}, .intensity = 7};
    constexpr std::uint64_t points = PointSource::batchPoints + 1;
    for (const ScanPoint& same : {black, red}) {
        const auto cloud = cloudOf(points, same, same);
        EXPECT_EQ(cloud->attributes, Attributes{});
        EXPECT_EQ(cloud->constant, (ConstantValues{same.color, same.intensity}));
        EXPECT_EQ(cloud->intensityRange[0], same.intensity);
        EXPECT_EQ(cloud->intensityRange[1], same.intensity);
        EXPECT_EQ(cloud->octree.run(0)->samples[0].r, same.color[0]) << "what is there stays";
        EXPECT_EQ(remarksOn(*cloud).size(), 2U);
    }
    const auto cloud = cloudOf(points, black, red);
    EXPECT_EQ(cloud->attributes, (Attributes{.color = true, .intensity = true}));
    EXPECT_EQ(cloud->constant, ConstantValues{});
    EXPECT_EQ(remarksOn(*cloud), std::vector<std::string>{});
    EXPECT_EQ(cloudOf(9, red, red, {})->constant, ConstantValues{}) << "what is not there is not constant";
}

TEST(BuildCloud, OnePointKeepsWhatIsNotZero) {
    const auto red = cloudOf(1, {}, {.color = {255, 0, 0}, .intensity = 7});
    EXPECT_EQ(red->attributes, (Attributes{.color = true, .intensity = true}));
    const auto black = cloudOf(1, {}, {.color = {0, 0, 0}, .intensity = 0});
    EXPECT_EQ(black->attributes, Attributes{});
}

TEST(BuildCloud, RefusesAnEmptyScan) {
    SyntheticSource source(0, test::ball, {});
    const auto cloud = buildCloud(source, {});
    ASSERT_FALSE(cloud);
    EXPECT_EQ(cloud.error().code, ErrorCode::Empty);
}

TEST(BuildCloud, TellsItsProgressStageByStage) {
    SyntheticSource source(200'000, test::ground, {});
    std::mutex mutex;
    std::vector<std::string> finished;
    bool within = true;
    const auto cloud = buildCloud(source, {}, [&](const Progress& p) {
        const std::lock_guard lock(mutex);
        within = within && p.done <= p.total && (p.total == 200'000 || p.unit == "nodes");
        if (p.done == p.total) finished.emplace_back(p.stage);
    });
    ASSERT_TRUE(cloud);
    EXPECT_TRUE(within);
    finished.erase(std::unique(finished.begin(), finished.end()), finished.end());
    EXPECT_EQ(finished, (std::vector<std::string>{"reading", "sorting", "building", "finishing"}));
}

TEST(Cloud, KnowsRangesCountsAndBounds) {
    const SyntheticSource::Make make = [](auto i, auto) {
        return ScanPoint{.position = {100 + double(i), 20, -5},
                         .color = {},
                         .intensity = std::uint16_t(1000 + i),
                         .classification = std::uint8_t(i % 3 == 0 ? 2 : 6)};
    };
    SyntheticSource source(300, make,
                           {.color = false, .intensity = true, .classification = true, .normal = false});
    const auto cloud = test::build(source);
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->points, 300u);
    EXPECT_EQ(cloud->bounds[0], glm::dvec3(100, 20, -5));
    EXPECT_EQ(cloud->bounds[1], glm::dvec3(399, 20, -5));
    EXPECT_EQ(cloud->origin, glm::dvec3(100, 0, -100));
    EXPECT_EQ(cloud->intensityRange, (std::array<std::uint16_t, 2>{1000, 1299}));
    EXPECT_EQ(cloud->classCounts[2], 100u);
    EXPECT_EQ(cloud->classCounts[6], 200u);
    EXPECT_EQ(cloud->title, "test");
    EXPECT_EQ(cloud->format, "synthetic");
}

TEST(Cloud, TheRevisionDependsOnPicturesAlone) {
    const auto revision = [](std::uint8_t red, const char* title) {
        SyntheticSource source(1000,
                               [=](auto i, auto n) {
                                   ScanPoint p = test::ball(i, n);
                                   p.color = {red, 0, 0};
                                   return p;
                               },
                               {.color = true});
        return (*buildCloud(source, {.title = title}))->revision;
    };
    EXPECT_EQ(revision(10, "a"), revision(10, "b"));
    EXPECT_NE(revision(10, "a"), revision(11, "a"));
}

TEST(Cloud, TheDefaultCameraSeesAllOfItFromTheSouthEast) {
    SyntheticSource source(5000, test::ground, {});
    const auto cloud = test::build(source);
    ASSERT_TRUE(cloud);
    for (const double aspect : {0.3, 1.0, 16.0 / 9, 4.0}) {
        View view;
        view.camera = cloud->defaultCamera(aspect);
        view.height = 500;
        view.width = int(500 * aspect);
        ASSERT_TRUE(validate(view));
        EXPECT_GT(view.camera.eye.x, view.camera.target.x);
        EXPECT_LT(view.camera.eye.y, view.camera.target.y);
        const auto viewpoint = Viewpoint::create(view, cloud->origin, cloud->bounds);
        ASSERT_TRUE(viewpoint);
        double farthest = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 c(cloud->bounds[corner & 1].x, cloud->bounds[corner >> 1 & 1].y,
                               cloud->bounds[corner >> 2].z);
            const glm::dvec4 inView = viewpoint->cloudToView * glm::dvec4(c - cloud->origin, 1);
            const glm::dvec3 at = viewpoint->project(glm::dvec3(inView));
            farthest =
                std::max({farthest, std::abs(at.x / view.width - 0.5), std::abs(at.y / view.height - 0.5)});
        }
        EXPECT_LE(farthest, 0.5);
        EXPECT_GE(farthest, 0.4);  // and not from farther away than needed
    }
}

TEST(Cloud, AModelThatStandsOnXZIsSeenUpright) {
    // A column of unit height on the plane y = 0 around the origin; the same one floating is a scan like any
    // other.
    const auto up = [](double foot) {
        SyntheticSource source(1000,
                               [foot](std::uint64_t i, std::uint64_t) {
                                   return ScanPoint{.position = {i % 10 * 0.02 - 0.09, foot + i % 101 * 0.01,
                                                                 i % 7 * 0.02 - 0.06}};
                               },
                               {});
        return test::build(source)->defaultCamera(1).up;
    };
    EXPECT_EQ(up(0), glm::dvec3(0, 1, 0));
    EXPECT_EQ(up(0.5), glm::dvec3(0, 0, 1));
}

TEST(Cloud, ACloudOfOnePointHasACameraToo) {
    SyntheticSource source(1, [](auto, auto) { return ScanPoint{.position = {471000, 4602888, 16}}; }, {});
    const auto cloud = test::build(source);
    ASSERT_TRUE(cloud);
    View view;
    view.camera = cloud->defaultCamera(16.0 / 9);
    EXPECT_TRUE(validate(view));
}

}  // namespace
}  // namespace scancast
