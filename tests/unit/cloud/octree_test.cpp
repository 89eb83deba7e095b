// Octrees of ordinary and of degenerate clouds.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;
using test::uniform;

std::vector<glm::dvec3> all(std::uint64_t n, const SyntheticSource::Make& make) {
    std::vector<glm::dvec3> out;
    for (std::uint64_t i = 0; i < n; ++i) out.push_back(make(i, n).position);
    return out;
}

std::shared_ptr<const Cloud> checked(std::uint64_t n, const SyntheticSource::Make& make,
                                     std::uint32_t leafPoints = 256) {
    SyntheticSource source(n, make, {});
    auto cloud = test::build(source, leafPoints);
    if (!cloud) return nullptr;
    test::checkStructure(*cloud, leafPoints);
    test::checkBounds(cloud->octree);
    test::checkEachPointOnce(*cloud, all(n, make));
    return cloud;
}

TEST(Octree, OfGround) {
    const auto cloud = checked(60'000, test::ground);
    ASSERT_TRUE(cloud);
    EXPECT_GT(cloud->octree.nodes().size(), 100u);
    EXPECT_LT(cloud->octree.sampleCount(), 2 * cloud->points);
}

TEST(Octree, OfABall) {
    checked(60'000, test::ball);
}

TEST(Octree, OfOnePoint) {
    const auto cloud = checked(1, [](auto, auto) {
        return ScanPoint{.position = {471000.25, 4602888.9, 16}};
    });
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->octree.nodes().size(), 1u);
    EXPECT_GT(cloud->spacing, 0);
}

TEST(Octree, OfTwoPoints) {
    const auto cloud = checked(2, [](auto i, auto) { return ScanPoint{.position = {double(i), 0, 0}}; });
    ASSERT_TRUE(cloud);
    EXPECT_NEAR(cloud->spacing, 1, 1e-6);
}

TEST(Octree, OfManyPointsAtOnePlace) {
    const auto cloud = checked(5000, [](auto i, auto) {
        return ScanPoint{.position = {1, 2, 3}, .color = {std::uint8_t(i), 0, 0}};
    });
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->octree.nodes().size(), 1u);
}

TEST(Octree, OfTwoPlacesWithManyPointsEach) {
    const auto cloud = checked(5000, [](auto i, auto) {
        return ScanPoint{.position = {double(i % 2), 2, 3}};
    });
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->octree.nodes().size(), 3u);
}

TEST(Octree, OfALine) {
    const auto cloud =
        checked(20'000, [](auto i, auto) { return ScanPoint{.position = glm::dvec3(i * 0.01)}; });
    ASSERT_TRUE(cloud);
    EXPECT_NEAR(cloud->spacing, 0.01 * std::sqrt(3), 1e-4);
}

TEST(Octree, AnOutlierDoesNotBlurTheRest) {
    const auto cloud = checked(5000, [](auto i, auto n) {
        return i == 0 ? ScanPoint{.position = {1e9, -1e9, 1e9}} : test::ball(i, n);
    });
    ASSERT_TRUE(cloud);
    // 5000 points on a ball of radius 10 are 0.5 apart; the outlier's own node may know no spacing.
    EXPECT_LT(cloud->spacing, 1.2);
}

TEST(Octree, OfPointsScatteredOverAllOf32Bits) {
    SyntheticSource source(
        1024,
        [](auto i, auto) {
            return ScanPoint{.position = glm::dvec3(uniform(i, 1), uniform(i, 2), uniform(i, 3)) * 4.29e9 -
                                         glm::dvec3(2.147e9)};
        },
        {}, 1.0);
    const auto cloud = test::build(source, 64);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 64);
    test::checkBounds(cloud->octree);
}

TEST(Octree, OfDistancesThatDoubleFromPointToPoint) {
    checked(
        40,
        [](auto i, auto) {
            return ScanPoint{.position = {std::ldexp(1.0, int(i)), 0, 0}};
        },
        1);
}

TEST(Octree, LeavesOfOnePoint) {
    checked(3000, test::ball, 1);
}

TEST(Octree, UtmCoordinatesKeepTheirMillimetres) {
    const SyntheticSource::Make make = [](auto i, auto) {
        return ScanPoint{
            .position = {471000 + uniform(i, 1) * 50, 4602000 + uniform(i, 2) * 50, uniform(i, 3)}};
    };
    SyntheticSource source(20'000, make, {}, 0.001, {400000, 4000000, 0});
    const auto cloud = test::build(source, 256);
    ASSERT_TRUE(cloud);
    std::vector<glm::dvec3> input = all(20'000, make);
    for (glm::dvec3& p : input) p = glm::round(p * 1000.0) / 1000.0;
    test::checkEachPointOnce(*cloud, input, 2e-9);  // on the file's own grid: two units in the last place
    EXPECT_EQ(cloud->origin, glm::dvec3(471000, 4602000, 0));
}

TEST(Octree, AGridThatPointsDoNotLieOnIsNotBelieved) {
    class Liar : public SyntheticSource {
      public:
        Liar() : SyntheticSource(1000, test::ball, {}, 0) {
            header_ = SyntheticSource::header();
            header_.gridStep = glm::dvec3(1);
        }
        const ScanHeader& header() const override { return header_; }

      private:
        ScanHeader header_;
    } source;
    const auto cloud = test::build(source);
    ASSERT_TRUE(cloud);
    test::checkEachPointOnce(*cloud, all(1000, test::ball));
}

TEST(Octree, AxesOfUnlikeGridsAreBothKept) {
    // Degrees and metres, as in geographic LAS files.
    class Degrees : public SyntheticSource {
      public:
        Degrees() : SyntheticSource(5000, make, {}) {
            header_ = SyntheticSource::header();
            header_.gridStep = {1e-7, 1e-7, 0.01};
        }
        static ScanPoint make(std::uint64_t i, std::uint64_t) {
            return {.position = {std::round(uniform(i, 1) * 2e5) * 1e-7,
                                 std::round(uniform(i, 2) * 1e5) * 1e-7,
                                 std::round(uniform(i, 3) * 4000) * 0.01}};
        }
        const ScanHeader& header() const override { return header_; }

      private:
        ScanHeader header_;
    } source;
    const auto cloud = test::build(source, 256);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 256);
    test::checkBounds(cloud->octree);
    test::checkEachPointOnce(*cloud, all(5000, Degrees::make));
}

TEST(Octree, InnerNodesHoldThousandsOfSamples) {
    SyntheticSource source(1'000'000, test::ball, {});
    const auto cloud = test::build(source, 16384);
    ASSERT_TRUE(cloud);
    for (const Node& n : cloud->octree.nodes()) {
        if (n.isLeaf()) continue;
        EXPECT_GE(n.sampleCount, 1000u);
        EXPECT_LE(n.sampleCount, 2 * 16384u + 8u);  // twice a full leaf
    }
}

TEST(Octree, NodesStayModestWhereDensitiesDifferAHundredfold) {
    // A finely scanned ball of radius 0.1 in a coarsely scanned landscape 200 wide.
    SyntheticSource source(600'000,
                           [](std::uint64_t i, std::uint64_t n) {
                               ScanPoint p = i % 2 ? test::ball(i, n) : test::ground(i, n);
                               if (i % 2) p.position = p.position * 0.01 + glm::dvec3(120, 70, 2);
                               return p;
                           },
                           {});
    const auto cloud = test::build(source, 4096);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 4096);
    for (const Node& n : cloud->octree.nodes()) {
        if (!n.isLeaf()) {
            EXPECT_LE(n.sampleCount, 2 * 4096u);
        }
    }
    EXPECT_LT(cloud->octree.sampleCount(), cloud->points * 3 / 2);
}

TEST(Octree, IsTheSameOnAnyNumberOfThreadsAndInAnyOrder) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
    const Attributes everything{.color = true, .intensity = true, .classification = true, .normal = true};
    constexpr std::uint64_t n = test::sized(300'000, 60'000);
    const SyntheticSource::Make make = [](std::uint64_t i, std::uint64_t count) {
        ScanPoint p = test::ball(i, count);
        p.intensity = std::uint16_t(i * 7);
        p.classification = std::uint8_t(i % 5);
        if (i % 10 == 0) p.position = glm::dvec3(1, 1, 1);  // equal positions, different colours
        return p;
    };
    const auto digest = [&](int threads, const SyntheticSource::Make& order) {
        SyntheticSource source(n, order, everything);
        const auto cloud = test::build(source, 4096, threads);
        return cloud ? cloud->revision : std::string();
    };
    const std::string one = digest(1, make);
    EXPECT_EQ(one.size(), 32u);
    EXPECT_EQ(digest(2, make), one);
    EXPECT_EQ(digest(5, make), one);
    EXPECT_EQ(digest(2, [&](std::uint64_t i, std::uint64_t count) { return make(count - 1 - i, count); }),
              one);
    // 7919 is prime to the number of points: another permutation.
    EXPECT_EQ(digest(2, [&](std::uint64_t i, std::uint64_t count) { return make(i * 7919 % count, count); }),
              one);
    EXPECT_NE(digest(2, [&](std::uint64_t i, std::uint64_t count) { return make(i + 1, count); }), one);
}

}  // namespace
}  // namespace scancast
