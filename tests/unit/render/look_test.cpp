// What a look decides of views that leave it open, and what the cloud decides without one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderer/render.hpp"
#include "renderer/style.hpp"

namespace scancast {
namespace {

CloudFacts ofBrightness(double median) {
    CloudFacts facts;
    facts.attributes.color = true;
    facts.usual.emplace().brightness = {median / 2, median, std::min(1.0, median * 1.5)};
    return facts;
}

TEST(AutomaticExposure, IsAtMostOneStopAndLeavesTheMiddleAlone) {
    EXPECT_EQ(automaticExposure(CloudFacts{}), 0) << "nothing is known of its colours";
    double last = 2;
    for (int i = 0; i <= 1000; ++i) {
        const double median = i / 1000.0, stops = automaticExposure(ofBrightness(median));
        EXPECT_GE(stops, -1) << median;
        EXPECT_LE(stops, 1) << median;
        EXPECT_TRUE(median < 0.3 || median > 0.75 || stops == 0) << median;
        if (i == 0) continue;  // black is no darkness: nothing would be seen of it however it was exposed
        EXPECT_LE(stops, last + 1e-12) << "the brighter, the less";
        last = stops;
    }
    EXPECT_EQ(automaticExposure(ofBrightness(0)), 0);
    EXPECT_GT(automaticExposure(ofBrightness(0.1)), 0.5);
    EXPECT_LT(automaticExposure(ofBrightness(1)), -0.2);
}

/// With colours and intensities, and a look.
Cloud lookedAt() {
    Cloud cloud;
    cloud.attributes = {true, true, false, false};
    cloud.bounds = {glm::dvec3(0), glm::dvec3(10, 10, 5)};
    cloud.usual.emplace().brightness = {0.05, 0.1, 0.2};
    Look& look = cloud.look.emplace();
    look.outline = {{0, 0, 0}, {10, 10, 5}, {10, 0, 0}, {0, 10, 5}};
    look.style.color = ColorSource::Elevation;
    look.style.byIntensity = true;
    look.style.colormap = "turbo";
    look.style.range = {1, 4};
    look.style.method = "point";
    Camera outside, inside;
    outside.eye = {30, -40, 20};
    inside.eye = {5, 5, 2};
    inside.target = {6, 5, 2};
    look.views = {{"from the south-east", false, outside}, {"inside", true, inside}};
    return cloud;
}

TEST(DecidedStyle, ColoursThatAreLeftOpenAreTheLooks) {
    const Cloud cloud = lookedAt();
    const Style style = decidedStyle(cloud, Style{});
    EXPECT_EQ(style.color, ColorSource::Elevation);
    EXPECT_TRUE(style.byIntensity);
    EXPECT_EQ(style.colormap, "turbo");
    EXPECT_EQ(style.range, cloud.look->style.range);
    EXPECT_EQ(style.exposure, automaticExposure(cloud));
    EXPECT_EQ(style.method, Style{}.method) << "a method is always said";
}

TEST(DecidedStyle, WhatIsSaidWins) {
    Cloud cloud = lookedAt();
    Style said;
    said.color = ColorSource::Rgb;
    said.exposure = -2;
    EXPECT_EQ(decidedStyle(cloud, said), said);
    said = {};
    said.range = {7, 8};
    EXPECT_EQ(decidedStyle(cloud, said).range, said.range);
    cloud.look->style.exposure = 0.5;
    EXPECT_EQ(decidedStyle(cloud, Style{}).exposure, 0.5) << "the look's before the cloud's own";
}

TEST(DecidedStyle, WithoutALookItIsWhatTheCloudHas) {
    Cloud cloud = lookedAt();
    cloud.look.reset();
    const auto chosen = [&] { return decidedStyle(cloud, Style{}).color; };
    EXPECT_EQ(chosen(), ColorSource::Rgb);
    cloud.attributes.color = false;
    EXPECT_EQ(chosen(), ColorSource::Intensity);
    cloud.attributes.intensity = false;
    EXPECT_EQ(chosen(), ColorSource::Elevation);
    cloud.look.emplace();
    EXPECT_EQ(chosen(), ColorSource::Elevation) << "a look that leaves the colour open, too";
}

TEST(DefaultView, IsTheLooksFirstViewInItsStyle) {
    const Cloud cloud = lookedAt();
    const View view = defaultView(cloud, 400, 300);
    EXPECT_EQ(view.width, 400);
    EXPECT_EQ(view.style.method, "point");
    EXPECT_EQ(decidedStyle(cloud, view.style).range, cloud.look->style.range);
    EXPECT_EQ(decidedStyle(cloud, view.style).colormap, "turbo");
    EXPECT_EQ(view.camera, cameraFor(*cloud.look, cloud.look->views[0], 4.0 / 3));
    const auto views = viewsOf(cloud, 4.0 / 3);
    ASSERT_EQ(views.size(), 2U);
    EXPECT_EQ(views[0].camera, view.camera);
    EXPECT_EQ(views[1].name, "inside");
    EXPECT_EQ(views[1].camera.eye, cloud.look->views[1].camera.eye);
    EXPECT_GT(views[1].camera.fov, cloud.look->views[1].camera.fov)
        << "a higher picture shows as much to the sides";
}

// A view's own word replaces all that goes with it: colours are not stretched over another attribute's range, methods
// are not lit by another's light.
TEST(DefaultView, NothingOfTheLookComesAlongWithAWordOfItsOwn) {
    Cloud cloud = lookedAt();
    cloud.surfels = true;
    cloud.look->style.method = "auto";
    cloud.look->style.shading = Shading::EyeDome;
    const auto lit = [&](const View& view) {
        const auto planned = plan(cloud, view);
        EXPECT_TRUE(planned) << planned.error().message;
        return planned && std::ranges::any_of((*planned)->passes, [](const Pass& pass) {
                   return std::holds_alternative<EyeDomePass>(pass);
               });
    };
    View view = defaultView(cloud, 400, 300);
    EXPECT_TRUE(lit(view));
    view.style.method = "disc";
    EXPECT_FALSE(lit(view));
    view = defaultView(cloud, 400, 300);
    view.style.color = ColorSource::Intensity;
    EXPECT_EQ(decidedStyle(cloud, view.style).range, std::nullopt);
    EXPECT_EQ(decidedStyle(cloud, view.style).colormap, Style().colormap);
    view.style.color = ColorSource::Auto;
    view.style.colormap = "grey";
    EXPECT_EQ(decidedStyle(cloud, view.style).colormap, "grey");
}

// As `param.scale=2` alone: for the method that is chosen, if it has that; a word of no method is none.
TEST(AutomaticMethod, TakesParametersOfTheChosenOne) {
    Cloud cloud = lookedAt();
    View view = defaultView(cloud, 400, 300);
    view.style.method = "auto";
    view.style.parameters = {{"sizePx", 7.0}};
    const auto planned = plan(cloud, view);
    ASSERT_TRUE(planned) << planned.error().message;
    EXPECT_EQ((*planned)->method, "paraboloid");
    EXPECT_EQ(std::get<NearestPass>((*planned)->passes.front()).size.sizePx, 7);
    view.style.parameters = {{"lowPass", 1.0}};
    EXPECT_TRUE(plan(cloud, view)) << "another method's";
    view.style.parameters = {{"sizePx", -7.0}};
    EXPECT_FALSE(plan(cloud, view));
    view.style.parameters = {{"sizePx2", 7.0}};
    const auto unknown = plan(cloud, view);
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().field, "param.sizePx2");
}

TEST(DefaultView, WithoutALookShowsTheWhole) {
    Cloud cloud = lookedAt();
    cloud.look.reset();
    const auto views = viewsOf(cloud, 1.5);
    ASSERT_EQ(views.size(), 1U);
    EXPECT_FALSE(views[0].inside);
    EXPECT_EQ(views[0].camera, cloud.defaultCamera(1.5));
    EXPECT_EQ(defaultView(cloud, 300, 200).camera, cloud.defaultCamera(1.5));
}

TEST(PictureRevision, ChangesWithTheLook) {
    Cloud cloud = lookedAt();
    cloud.revision = "abc";
    const std::string with = pictureRevision(cloud);
    EXPECT_NE(with, "abc");
    EXPECT_EQ(pictureRevision(cloud), with);
    cloud.look->views[1].camera.fov += 1;
    EXPECT_NE(pictureRevision(cloud), with);
    cloud.look.reset();
    EXPECT_EQ(pictureRevision(cloud), "abc");
}

}  // namespace
}  // namespace scancast
