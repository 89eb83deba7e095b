// Near infrared of whole clouds: of 8 and 16 bits, in memory and in a file, whatever else stands beside the samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;

constexpr std::uint64_t points = 20'000;

/// Ground, and one point in a thousand far away, so that some chunks are one leaf. The last byte of a point's colour is
/// its near infrared, times `scale`: what it must be, sample by sample.
std::unique_ptr<SyntheticSource> scan(std::uint16_t scale) {
    const auto make = [scale](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = test::ground(i, n);
        if (i % 1000 == 7) p.position += glm::dvec3(3000, 0, 0);
        p.color = {std::uint8_t(i), 7, std::uint8_t(255 * test::uniform(i, 9))};
        p.nearInfrared = std::uint16_t(p.color[2] * scale);
        return p;
    };
    return std::make_unique<SyntheticSource>(points, make, Attributes{.color = true, .nearInfrared = true},
                                             0.001);
}

OctreeShape shapeWith(bool surfels, bool curvature) {
    OctreeShape shape;
    shape.leafPoints = 500;
    shape.chunkPoints = 4000;
    shape.surfels = surfels;
    shape.curvature = curvature;
    return shape;
}

/// Means of equal numbers are equal, so this holds on every level.
void expectLastColor(std::span<const Sample> samples, std::span<const BesideWord> beside) {
    ASSERT_EQ(beside.size(), samples.size());
    for (std::size_t s = 0; s < samples.size(); ++s) ASSERT_EQ(nearInfraredIn(beside[s]), samples[s].b) << s;
}

/// What somebody who reads the file must find, and what is in memory.
void expectFileIsAsMemory(const OctreeShape& shape, std::uint16_t scale) {
    const test::TemporaryFolder folder;
    BuildOptions inMemory;
    inMemory.shape = shape;
    const auto cloud = buildCloud(*scan(scale), inMemory, {});
    ASSERT_TRUE(cloud) << cloud.error().message;
    IngestOptions options;
    options.shape = shape;
    options.output = folder / "infrared.scan";
    std::vector<std::unique_ptr<PointSource>> sources;
    sources.push_back(scan(scale));
    const auto report = ingest(std::move(sources), options, {}, {});
    ASSERT_TRUE(report) << report.error().message;
    const auto file = CloudFile::open(options.output);
    ASSERT_TRUE(file) << file.error().message;
    const auto planes = (*file)->planes();
    const auto infrared = std::ranges::find(planes, nearInfraredPlane());
    ASSERT_NE(infrared, planes.end());
    EXPECT_EQ(planes.size(), shape.curvatures() ? 2u : 1u);
    EXPECT_TRUE((*file)->facts().attributes.nearInfrared);
    EXPECT_EQ((*file)->facts().attributes, (*cloud)->attributes);
    EXPECT_EQ((*file)->facts().revision, (*cloud)->revision);
    EXPECT_EQ((*file)->facts().usual, (*cloud)->usual);
    ASSERT_EQ((*file)->nodes().size(), (*cloud)->octree.nodes().size());
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) {
        const auto run = (*cloud)->octree.run(i);
        ASSERT_TRUE(run);
        ASSERT_NO_FATAL_FAILURE(expectLastColor(run->samples, run->beside)) << "node " << i;
        const auto values = (*file)->plane(i, std::size_t(infrared - planes.begin()));
        ASSERT_TRUE(values) << values.error().message;
        ASSERT_TRUE(std::ranges::equal(
            *values, run->beside, {}, [](std::byte b) { return std::to_integer<std::uint8_t>(b); },
            nearInfraredIn))
            << "node " << i;
        if (!shape.curvatures()) continue;
        const auto curvatures = (*file)->plane(i, 0);
        ASSERT_TRUE(curvatures);
        std::vector<CurvatureCode> codes(run->beside.size());
        std::ranges::copy(*curvatures, std::as_writable_bytes(std::span(codes)).begin());
        ASSERT_TRUE(std::ranges::equal(codes, run->beside, {}, {}, curvatureIn)) << "node " << i;
    }
}

TEST(NearInfrared, Of16BitsKeepsItsHighByteAndOf8BitsAll) {
    for (const std::uint16_t scale : {1, 256, 257}) {
        SCOPED_TRACE(scale);
        expectFileIsAsMemory(shapeWith(false, false), scale);
    }
}

/// Sides are found afterwards: until then it waits with the surfels.
TEST(NearInfrared, GoesWithSurfelsAndCurvatures) {
    for (const bool curvature : {false, true}) {
        SCOPED_TRACE(curvature);
        expectFileIsAsMemory(shapeWith(true, curvature), 257);
    }
}

TEST(NearInfrared, ThatIsTheSameEverywhereIsNone) {
    const auto make = [](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = test::ground(i, n);
        p.nearInfrared = 4711;
        return p;
    };
    SyntheticSource source(1000, make, {.nearInfrared = true}, 0.001);
    const auto cloud = buildCloud(source, {}, {});
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_FALSE((*cloud)->attributes.nearInfrared);
    EXPECT_FALSE(hasNearInfrared(**cloud));
    EXPECT_EQ((*cloud)->notes, std::vector<std::string>{
                                   "all points have the same near infrared, 4711: that is taken for none"});
    EXPECT_TRUE((*cloud)->octree.run(0)->beside.empty());
}

/// Whoever has none is drawn from the same bytes as before there was any.
TEST(NearInfrared, LeavesCloudsWithoutItAlone) {
    SyntheticSource source(1000, test::ground, {.color = true}, 0.001);
    const auto cloud = buildCloud(source, {}, {});
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_TRUE((*cloud)->companions.empty());
    EXPECT_TRUE((*cloud)->octree.run(0)->beside.empty());
}

}  // namespace
}  // namespace scancast
