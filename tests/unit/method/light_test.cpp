#include "renderer/method/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace scancast {
namespace {

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::length(a - b), 1e-12) << a.x << ", " << a.y << ", " << a.z;
}

TEST(Light, ComesFromWhereTheSunStands) {
    const glm::dvec3 z(0, 0, 1);
    expectNear(wayToSun({0, 0}, z), {0, 1, 0});     // north
    expectNear(wayToSun({90, 0}, z), {1, 0, 0});    // east
    expectNear(wayToSun({-90, 0}, z), {-1, 0, 0});  // west
    expectNear(wayToSun({123, 90}, z), z);
    expectNear(wayToSun({180, 30}, z), {0, -std::sqrt(0.75), 0.5});
}

TEST(Light, KnowsOtherWaysUp) {
    expectNear(wayToSun({0, 0}, {0, 1, 0}), {0, 0, -1});  // away from who looks at a thing from its front
    expectNear(wayToSun({90, 0}, {0, 1, 0}), {1, 0, 0});
    expectNear(wayToSun({0, 0}, {0, -1, 0}), {0, 0, 1});
    for (const glm::dvec3& up : {glm::dvec3(0.6, 0, 0.8), {0, 0.28, 0.96}, {1, 0, 0}, {0, 0, -1}}) {
        const glm::dvec3 north = wayToSun({0, 0}, up), east = wayToSun({90, 0}, up);
        EXPECT_NEAR(glm::dot(north, up), 0, 1e-12);
        expectNear(glm::cross(east, north), up);
        EXPECT_NEAR(glm::length(wayToSun({77, 33}, up)), 1, 1e-12);
        EXPECT_NEAR(glm::dot(wayToSun({77, 30}, up), up), 0.5, 1e-12);
    }
}

TEST(Light, FindsTheSunAlongAWay) {
    for (const glm::dvec3& up : {glm::dvec3(0, 0, 1), {0, 1, 0}, {0, -1, 0}, {0.6, 0, 0.8}})
        for (const std::array<double, 2>& sun :
             {std::array{0.0, 0.0}, {90.0, 10.0}, {-135.0, 40.0}, {17.0, 89.0}}) {
            const auto found = sunAlong(3.0 * wayToSun(sun, up), up);
            EXPECT_TRUE(found == sun) << found[0] << ", " << found[1];
        }
}

TEST(Light, IsMadeOfShares) {
    const auto passOf = [](const LightRig& light) { return phongPass(light, {0, 0, 1}); };
    const PhongPass half = passOf({.ambient = 0.5, .headlight = 0.25, .sun = {}}),
                    whole = passOf({.ambient = 1, .headlight = 0.5, .sun = {}});
    EXPECT_FLOAT_EQ(half.ambient, whole.ambient);
    EXPECT_FLOAT_EQ(half.headlight, whole.headlight);
    EXPECT_EQ(passOf({}).sunlight, 0) << "there is no sun";
    EXPECT_FLOAT_EQ(passOf({.ambient = 0.3, .headlight = 0, .sun = {}}).ambient, 1)
        << "the same everywhere: nothing changes";
    const PhongPass sunny = passOf({.sun = {{135, 40}}});
    EXPECT_GT(sunny.sunlight, 0);
    EXPECT_LT(sunny.ambient, passOf({}).ambient) << "what the sun gives, others need not";
    EXPECT_EQ(passOf({.ambient = 0, .headlight = 0, .sun = {}}).headlight, 0) << "dark, and no division by 0";
}

TEST(Light, CastsShadowsWhereThereIsASun) {
    LightRig light;
    light.shadow = 0.8;
    EXPECT_FALSE(castsShadows(light)) << "there is no sun";
    light.sun = {{135, 40}};
    EXPECT_TRUE(castsShadows(light));
    EXPECT_TRUE(phongPass(light, {0, 0, 1}).shadows);
    EXPECT_EQ(shadowPass(light, Shading::Phong).share, 0) << "Phong takes it from the sunlight";
    EXPECT_FLOAT_EQ(shadowPass(light, Shading::Unlit).share, 0.5f)
        << "half of what comes from the sky and the sun";
    EXPECT_FLOAT_EQ(shadowPass(light, Shading::EyeDome).strength, 0.8f);
    light.sunlight = 0;
    EXPECT_FALSE(castsShadows(light)) << "it does not shine";
}

}  // namespace
}  // namespace scancast
