#include "renderer/sun.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {
namespace {

const std::array<glm::dvec3, 2> box{glm::dvec3(-50, -30, 0), glm::dvec3(60, 40, 25)};
const glm::dvec3 way = glm::normalize(glm::dvec3(1, -2, 1.5));

TEST(SunViewpoint, SeesAllThatThePictureShowsAndWhatStandsBeforeIt) {
    Numbers numbers(8);
    for (const Viewpoint& picture :
         {lookAt({0, -100, 50}, {0, 0, 0}, 320, 200), lookAt({0, 0, 2}, {9, 5, 1}, 320, 200),
          lookAtOrthographic({0, -100, 50}, {10, 0, 0}, 320, 200, 12)}) {
        const auto sun = sunViewpoint(box, picture, way);
        ASSERT_TRUE(sun);
        EXPECT_LE(std::max(sun->width, sun->height), largestShadowMap);
        int seen = 0;
        for (int i = 0; i < 200'000; ++i) {
            const glm::dvec3 p(numbers.uniform(box[0].x, box[1].x), numbers.uniform(box[0].y, box[1].y),
                               numbers.uniform(box[0].z, box[1].z));
            const glm::dvec3 at = picture.project(glm::dvec3(picture.cloudToView * glm::dvec4(p, 1)));
            const bool shown = at.z > picture.near && at.x >= 0 && at.y >= 0 && at.x < 320 && at.y < 200;
            const glm::dvec3 inMap = sun->project(glm::dvec3(sun->cloudToView * glm::dvec4(p, 1)));
            EXPECT_GT(inMap.z, sun->near) << "nothing stands behind the sun";
            if (!shown) continue;
            ++seen;
            ASSERT_TRUE(inMap.x > 2 && inMap.y > 2 && inMap.x < sun->width - 2 && inMap.y < sun->height - 2);
        }
        EXPECT_GT(seen, 10);
    }
}

TEST(SunViewpoint, KeepsItsPixelsInPlace) {
    // Right because a point's place in two maps of equal pixels differs by whole pixels: its shadow does not crawl.
    const auto one = sunViewpoint(box, lookAt({0, -100, 50}, {0, 0, 0}, 320, 200), way);
    const auto other = sunViewpoint(box, lookAt({3.3, -100, 50.7}, {3.3, 0, 0}, 320, 200), way);
    ASSERT_TRUE(one && other);
    ASSERT_EQ(one->pixelsPerUnit, other->pixelsPerUnit);
    const auto placeIn = [](const Viewpoint& sun) {
        return sun.project(glm::dvec3(sun.cloudToView * glm::dvec4(7, 8, 9, 1)));
    };
    const glm::dvec3 moved = placeIn(*one) - placeIn(*other);
    EXPECT_NEAR(moved.x, std::round(moved.x), 1e-6);
    EXPECT_NEAR(moved.y, std::round(moved.y), 1e-6);
}

TEST(SunViewpoint, IsNoneWhereNothingIsShown) {
    EXPECT_FALSE(sunViewpoint(box, lookAt({0, -100, 50}, {0, -200, 50}, 320, 200), way));
}

}  // namespace
}  // namespace scancast::test
