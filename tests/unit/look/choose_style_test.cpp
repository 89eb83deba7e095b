// Which styles a cloud may be shown in: those that show what it has.
#include "renderer/look/choose_style.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/method/light.hpp"
#include "tests/unit/look/scenes.hpp"

namespace scancast {
namespace {

SurveyedScene someScene(SceneKind kind) {
    SurveyedScene scene;
    scene.kind = kind;
    scene.points = test::landscape(1000, {0, 0}, 5, 10);
    scene.box = boxOf(scene.points);
    return scene;
}

// Right because a style asks for an attribute by its colour, its shading and its factor, and for nothing else.
TEST(StylesFor, AskForWhatTheCloudHas) {
    for (unsigned has = 0; has < 64; ++has)
        for (std::size_t kind = 0; kind < sceneKindNames.size(); ++kind)
            for (const bool map : {false, true}) {
                SurveyedScene scene = someScene(SceneKind(kind));
                scene.onlyFromAbove = map;
                CloudFacts facts = test::factsOf(scene.points, "LAS 1.2");
                facts.attributes = {bool(has & 1), bool(has & 2), bool(has & 4), bool(has & 8)};
                facts.surfels = has & 16;
                if (has & 4) facts.classCounts = {0, 0, 400, 0, 0, 300, 300};
                if (has & 32) facts.usual.emplace().intensity = {3, 400};
                const auto styles = stylesFor(facts, scene);
                ASSERT_FALSE(styles.empty());
                for (const StyleChoice& choice : styles) {
                    const Style& style = choice.style;
                    EXPECT_FALSE(choice.reason.empty());
                    EXPECT_TRUE(style.color != ColorSource::Rgb || facts.attributes.color);
                    const bool byIntensity = style.color == ColorSource::Intensity || style.byIntensity;
                    EXPECT_TRUE(!byIntensity || facts.attributes.intensity);
                    EXPECT_TRUE(style.color != ColorSource::Classification ||
                                facts.attributes.classification);
                    EXPECT_TRUE(style.shading != Shading::Phong || facts.surfels || facts.attributes.normal);
                    EXPECT_TRUE(!style.byIntensity || takesIntensity(style.color));
                    const bool asUsual = style.color == ColorSource::Intensity && facts.usual;
                    EXPECT_TRUE(!asUsual || style.range == facts.usual->intensity);
                    View view;
                    view.style = style;
                    EXPECT_TRUE(validate(view));
                }
                EXPECT_EQ(styles.front().style.color == ColorSource::Rgb, facts.attributes.color);
            }
}

// Right because left, above and before are dot products with the camera's axes.
TEST(Sidelight, ComesFromTheUpperLeftOfTheFirstCamera) {
    for (const glm::dvec3& up : {glm::dvec3(0, 0, 1), {0, 1, 0}, {0, -1, 0}})
        for (int i = 0; i < 8; ++i) {
            const double angle = 0.8 * i;
            const glm::dvec3 across(up.z, 0, 1 - up.z), along = glm::cross(up, across);
            Camera camera;
            camera.target = {5, 6, 7};
            const glm::dvec3 back =
                glm::normalize(across * std::cos(angle) + along * std::sin(angle) + up * 0.4);
            camera.eye = camera.target + 20.0 * back;
            camera.up = up;
            const LightRig light = sidelight(camera, up);
            const glm::dvec3 sun = wayToSun(light.sun.value(), up);
            EXPECT_LT(glm::dot(sun, glm::cross(up, back)), -0.5);
            EXPECT_GT(glm::dot(sun, up), 0.3);
            EXPECT_GT(glm::dot(sun, back), 0.3);
            View view;
            view.style.light = light;
            EXPECT_TRUE(validate(view));
        }
}

TEST(Sidelight, FromAboveIsStillInTheSky) {
    Camera camera;
    camera.eye = {0, 0, 9};
    camera.up = {0, 1, 0};
    const auto sun = sidelight(camera, {0, 0, 1}).sun.value();
    EXPECT_GE(sun[1], 10);
    EXPECT_LT(wayToSun(sun, {0, 0, 1}).x, -0.5) << "left in the picture";
}

TEST(StylesFor, ClassesTellOnlyWhereTheyDiffer) {
    const SurveyedScene scene = someScene(SceneKind::Airborne);
    CloudFacts facts = test::factsOf(scene.points, "LAS 1.2");
    facts.attributes.classification = true;
    const auto first = [&](std::uint64_t ground, std::uint64_t buildings, std::uint64_t unclassified) {
        facts.classCounts = {};
        facts.classCounts[2] = ground;
        facts.classCounts[6] = buildings;
        facts.classCounts[1] = unclassified;
        return stylesFor(facts, scene).front().style.color;
    };
    EXPECT_EQ(first(500, 500, 0), ColorSource::Classification);
    EXPECT_EQ(first(990, 10, 0), ColorSource::Elevation) << "nearly all the same";
    EXPECT_EQ(first(200, 200, 600), ColorSource::Elevation) << "most are not classified";
}

}  // namespace
}  // namespace scancast
