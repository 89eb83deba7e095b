#include "renderer/cloud/build/nodes/spacing.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "renderer/cloud/build/nodes/tangent_plane.hpp"
#include "renderer/cloud/build/nodes/voronoi_cell.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::uniform;

std::vector<glm::vec3> lattice(int columns, int rows, double dx, double dy) {
    std::vector<glm::vec3> out;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) out.emplace_back(x * dx, y * dy, 0);
    return out;
}

// A square grid's spacing is its pitch by definition, at any scale and in any direction.
TEST(Spacing, OfASquareGridIsItsPitch) {
    for (const double pitch : {1e-9, 0.01, 1.0, 1e6})
        EXPECT_NEAR(estimateSpacing(lattice(50, 50, pitch, pitch)).closing / pitch, 1, 1e-3) << pitch;
    std::vector<glm::vec3> turned;
    for (const glm::vec3& p : lattice(50, 50, 1, 1))
        turned.emplace_back(0.6f * p.x, 0.64f * p.x + 0.6f * p.y, 0.48f * p.x - 0.8f * p.y);
    EXPECT_NEAR(estimateSpacing(turned).closing, 1, 1e-3);
}

// The middle of the gap between two lines is half their distance from both; √2 of that is the equivalent
// pitch.
TEST(Spacing, OfScanLinesFollowsTheDistanceBetweenLines) {
    for (const double ratio : {4.0, 10.0, 20.0}) {
        const double spacing = estimateSpacing(lattice(400, 20, 1 / ratio, 1)).closing;
        EXPECT_GT(spacing, 0.7) << ratio;
        EXPECT_LT(spacing, 0.8) << ratio;
        EXPECT_NEAR(estimateSpacing(lattice(400, 20, 1 / ratio, 1)).mean, std::sqrt(1 / ratio), 1e-3)
            << ratio;
    }
}

TEST(Spacing, OfALineIsTheDistanceOfItsPoints) {
    EXPECT_NEAR(estimateSpacing(lattice(500, 1, 0.5, 1)).closing, 0.5, 1e-3);
}

// Voronoi cells share the surface out among the samples, so the mean counts them, however they are placed.
TEST(Spacing, TheMeanCountsTheSamplesOfASurface) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 6400; ++i) points.emplace_back(40 * uniform(i, 1), 40 * uniform(i, 2), 0);
    EXPECT_NEAR(estimateSpacing(points).mean, 0.5, 0.05);
    EXPECT_GT(estimateSpacing(points).closing, 0.7);
    EXPECT_NEAR(estimateSpacing(lattice(50, 50, 3, 3)).mean, 3, 1e-3);
}

TEST(Spacing, IsUnknownForOnePlace) {
    EXPECT_EQ(estimateSpacing({}).closing, 0);
    EXPECT_EQ(estimateSpacing(std::vector<glm::vec3>(1)).closing, 0);
    EXPECT_EQ(estimateSpacing(std::vector<glm::vec3>(500, glm::vec3(3))).closing, 0);
}

TEST(Spacing, EqualPointsDoNotCount) {
    std::vector<glm::vec3> doubled;
    for (const glm::vec3& p : lattice(40, 40, 1, 1)) doubled.insert(doubled.end(), {p, p, p});
    EXPECT_NEAR(estimateSpacing(doubled).closing, 1, 1e-3);
}

TEST(Spacing, AFewStraysDoNotMatter) {
    std::vector<glm::vec3> points = lattice(60, 60, 1, 1);
    for (int i = 0; i < 20; ++i) points.emplace_back(1000 * uniform(i, 1), 1000 * uniform(i, 2), 1000);
    EXPECT_NEAR(estimateSpacing(points).closing, 1, 0.05);
}

TEST(TangentPlane, OfATiltedPlane) {
    std::vector<glm::vec3> offsets;
    for (int i = 0; i < 100; ++i) {
        const double u = 2 * uniform(i, 1) - 1, v = uniform(i, 2) - 0.5;
        offsets.emplace_back(0.6 * u, 0.8 * u, v);
    }
    const TangentPlane plane = tangentPlane(offsets);
    EXPECT_NEAR(std::abs(plane.first.x), 0.6, 0.1);
    EXPECT_GT(plane.variance[0], plane.variance[1]);
    EXPECT_NEAR(plane.variance[2], 0, 1e-7);
}

TEST(VoronoiCell, OfASquareGrid) {
    VoronoiCell cell(10);
    EXPECT_TRUE(cell.isOpen());
    for (const glm::dvec2 d : {glm::dvec2(1, 0), {0, 1}, {-1, 0}}) cell.cut(d);
    EXPECT_TRUE(cell.isOpen());
    cell.cut({0, -1});
    EXPECT_FALSE(cell.isOpen());
    EXPECT_DOUBLE_EQ(cell.squaredReach(), 0.5);
    cell.cut({3, 3});  // too far to matter
    EXPECT_DOUBLE_EQ(cell.squaredReach(), 0.5);
}

}  // namespace
}  // namespace scancast
