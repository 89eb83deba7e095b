// Lengths, angles and areas of shapes whose measures are known by name: right triangles, squares, tilted rectangles.
#include "protocol/measure/vertices.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scancast::test {
namespace {

// As UTM coordinates are: what is measured must not drown in them.
const glm::dvec3 utm(389400.25, 5819700.5, 34.125);

std::vector<glm::dvec3> moved(std::vector<glm::dvec3> points) {
    for (glm::dvec3& p : points) p += utm;
    return points;
}

TEST(Vertices, ALineIsItsLegs) {
    const auto line = measurePolyline(moved({{0, 0, 0}, {3, 4, 12}, {3, 4, 2}}));
    EXPECT_DOUBLE_EQ(line.legs[0].length, 13);
    EXPECT_DOUBLE_EQ(line.legs[0].horizontal, 5);
    EXPECT_DOUBLE_EQ(line.legs[1].length, 10);
    EXPECT_DOUBLE_EQ(line.length, 23);
    EXPECT_DOUBLE_EQ(line.horizontal, 5);
    EXPECT_DOUBLE_EQ(line.vertical, 2);
    EXPECT_DOUBLE_EQ(line.climb, 12);
    EXPECT_DOUBLE_EQ(line.descent, 10);
}

TEST(Vertices, HeightsOfAnotherUnitAreBroughtIntoThatOfXAndY) {
    // Feet in plan view, metres in height.
    const auto line = measurePolyline(moved({{0, 0, 0}, {3, 0, 4 * 0.3048}}), 1 / 0.3048);
    EXPECT_NEAR(line.length, 5, 1e-9);
    EXPECT_DOUBLE_EQ(line.horizontal, 3);
    EXPECT_NEAR(line.vertical, 4 * 0.3048, 1e-9) << "in its own unit";
}

TEST(Vertices, AnglesAreThoseBetweenLegs) {
    const auto angles = measureAngles(moved({{1, 0, 0}, {0, 0, 0}, {0, 1, 1}, {0, 1, 1}, {0, 2, 1}}));
    ASSERT_EQ(angles.size(), 3U);
    EXPECT_NEAR(*angles[0].space, 90, 1e-9);
    EXPECT_NEAR(*angles[0].plan, 90, 1e-9);
    EXPECT_FALSE(angles[1].space) << "a leg without length has no direction";
    const auto steep = measureAngles(moved({{0, 0, 1}, {0, 0, 0}, {1, 0, 0}}));
    EXPECT_NEAR(*steep[0].space, 90, 1e-9);
    EXPECT_FALSE(steep[0].plan) << "upright legs have none in plan view";
}

TEST(Vertices, AnAreaIsThatOfItsPlaneAndOfItsPlan) {
    // 3 wide, 5 along a slope of 4 : 3.
    const auto roof = measureArea(moved({{0, 0, 0}, {3, 0, 0}, {3, 3, 4}, {0, 3, 4}}));
    EXPECT_NEAR(roof.plane, 15, 1e-9);
    EXPECT_NEAR(roof.plan, 9, 1e-9);
    EXPECT_NEAR(roof.perimeter, 16, 1e-9);
    EXPECT_NEAR(roof.planPerimeter, 12, 1e-9);
    EXPECT_NEAR(roof.off, 0, 1e-9);
    EXPECT_NEAR(roof.normal.y, -0.8, 1e-9);
    EXPECT_NEAR(roof.normal.z, 0.6, 1e-9);
    EXPECT_FALSE(roof.crossing);
    const auto wall = measureArea(moved({{0, 0, 0}, {6, 8, 0}, {6, 8, 3}, {0, 0, 3}}));
    EXPECT_NEAR(wall.plane, 30, 1e-9);
    EXPECT_NEAR(wall.plan, 0, 1e-9);
}

TEST(Vertices, OtherOrdersAndCornersInsideChangeNothing) {
    const auto l = measureArea(moved({{0, 0, 0}, {0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {3, 1, 0}, {3, 0, 0}}));
    EXPECT_NEAR(l.plan, 4, 1e-9);
    EXPECT_FALSE(l.crossing);
}

TEST(Vertices, EdgesThatCrossAreNamed) {
    const auto bow = measureArea(moved({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}));
    ASSERT_TRUE(bow.crossing);
    EXPECT_EQ(*bow.crossing, (std::array<std::size_t, 2>{0, 2}));
}

}  // namespace
}  // namespace scancast::test
