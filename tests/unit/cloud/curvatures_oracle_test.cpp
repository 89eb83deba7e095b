// Curvatures of whole clouds, on every level of the octree, in memory and in a file: docs/spec/surfels.md §11.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;

constexpr std::uint64_t points = 60000;
constexpr double radius = 2;

/// A ball of radius 2; with normals, those point outwards times `side`, else nobody knows.
std::unique_ptr<SyntheticSource> ball(double side) {
    const auto make = [side](std::uint64_t i, std::uint64_t n) {
        const double z = 1 - 2 * (double(i) + 0.5) / double(n);
        const double turn = double(i) * std::numbers::pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
        ScanPoint p;
        p.normal = glm::vec3(float(r * std::cos(turn)), float(r * std::sin(turn)), float(z));
        p.position = radius * glm::dvec3(p.normal);
        p.normal *= float(side);
        return p;
    };
    return std::make_unique<SyntheticSource>(points, make, Attributes{.normal = side != 0});
}

OctreeShape shape() {
    OctreeShape s;
    s.leafPoints = 1000;
    s.surfels = true;
    return s;
}

std::shared_ptr<const Cloud> cloudOf(double side) {
    BuildOptions options;
    options.shape = shape();
    auto built = buildCloud(*ball(side), options, {});
    EXPECT_TRUE(built) << built.error().message;
    return built ? *built : nullptr;
}

/// Right because a ball of radius 2 has 1/2 everywhere, from near and from far: a coarse stand-in is still the ball. By
/// level; relative to where the sample's own normal points.
void expectHalf(const Cloud& cloud) {
    std::map<int, std::vector<double>> errors;
    for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i) {
        const Node& node = cloud.octree.node(i);
        const auto run = cloud.octree.run(i);
        ASSERT_TRUE(run);
        ASSERT_EQ(run->beside.size(), run->samples.size());
        for (std::size_t s = 0; s < run->samples.size(); ++s) {
            const glm::vec3 n = decodeNormal(run->samples[s].normal);
            const glm::dvec3 out = position(node, run->samples[s]) + cloud.origin;
            const double sign = glm::dot(glm::dvec3(n), out) < 0 ? -1 : 1;
            const Curvature c = decodeCurvature(run->beside[s], n, node.radiusUnit);
            errors[node.level].push_back(
                std::max(std::abs(sign * c.k1 - 1 / radius), std::abs(sign * c.k2 - 1 / radius)));
        }
    }
    ASSERT_GE(errors.size(), 3u);
    for (auto& [level, all] : errors) {
        SCOPED_TRACE("level " + std::to_string(level));
        std::ranges::sort(all);
        EXPECT_LT(all[all.size() / 2], 0.05);
        EXPECT_LT(all[all.size() * 9 / 10], 0.15);
    }
}

TEST(Curvatures, OfABallAreOneOverItsRadiusOnEveryLevelOnEitherSide) {
    for (const double side : {1.0, -1.0}) {
        SCOPED_TRACE(side);
        const auto cloud = cloudOf(side);
        ASSERT_TRUE(cloud);
        expectHalf(*cloud);
        ASSERT_TRUE(cloud->usual);
        EXPECT_NEAR(cloud->usual->curvature[0], side / radius, 0.1);
        EXPECT_NEAR(cloud->usual->curvature[1], side / radius, 0.1);
    }
}

/// Sides are found after the surfels, and turn them with their curvatures.
TEST(Curvatures, TurnWithTheSidesThatAreFound) {
    const auto cloud = cloudOf(0);
    ASSERT_TRUE(cloud);
    ASSERT_TRUE(cloud->sides);
    EXPECT_GT(cloud->sides->sure, 0.9);
    expectHalf(*cloud);
    EXPECT_NEAR(cloud->usual->curvature[0], 1 / radius, 0.1)
        << "a ball that was scanned from outside is convex";
}

TEST(Curvatures, AreTheSameInAFileAndTellRevisionsApart) {
    const test::TemporaryFolder folder;
    const auto ingested = [&](bool curvature) {
        IngestOptions options;
        options.shape = shape();
        options.shape.curvature = curvature;
        options.output = folder / (curvature ? "bent.scan" : "flat.scan");
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(ball(0));
        const auto report = ingest(std::move(sources), options, {}, {});
        EXPECT_TRUE(report) << report.error().message;
        auto file = CloudFile::open(options.output);
        EXPECT_TRUE(file);
        return file ? *file : nullptr;
    };
    const auto cloud = cloudOf(0);
    const auto file = ingested(true);
    ASSERT_TRUE(file && cloud);
    EXPECT_EQ(file->facts().revision, cloud->revision);
    EXPECT_EQ(file->facts().usual, cloud->usual);
    ASSERT_TRUE(hasCurvature(file->facts()));
    for (std::uint32_t i = 0; i < file->nodes().size(); ++i) {
        const auto values = file->plane(i, 0);
        ASSERT_TRUE(values) << values.error().message;
        const auto run = cloud->octree.run(i);
        ASSERT_TRUE(std::ranges::equal(*values, std::as_bytes(run->beside))) << "node " << i;
    }
    const auto without = ingested(false);
    ASSERT_TRUE(without);
    EXPECT_FALSE(hasCurvature(without->facts()));
    EXPECT_NE(without->facts().revision, cloud->revision);
    EXPECT_TRUE(without->planes().empty());
    EXPECT_GT(file->bytes(), without->bytes());
    EXPECT_LT(double(file->bytes()), 1.3 * double(without->bytes()));
}

}  // namespace
}  // namespace scancast
