// The front door with a device that only takes notes: what is asked of devices, and what is refused before.
#include "renderer/render.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "renderer/method/method.hpp"

namespace scancast {
namespace {

using testing::HasSubstr;

/// Draws each pixel as a function of its place in the whole picture, so that a tile pasted wrongly shows.
class NotingDevice : public Device {
  public:
    DeviceInfo info() const override { return {"noting", "", "", "", false, "noting", -1, mirrors}; }
    std::int64_t pixelsAtOnce() const override { return atOnce; }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "cancelled");
        windows.push_back(drawing.window);
        jitter.assign(drawing.jitter.begin(), drawing.jitter.end());
        passes.assign(drawing.passes.begin(), drawing.passes.end());
        color = drawing.color;
        cutSamples = drawing.mainView().cut.samples;
        reflections = drawing.reflections().size();
        regionsDropped = drawing.mainView().filter.dropped.size();
        const Window& w = drawing.window;
        Frame frame{w.width, w.height, {}, {}, {}};
        for (int y = w.y; y < w.y + w.height; ++y) {
            for (int x = w.x; x < w.x + w.width; ++x) {
                for (const int value : {x, y, x + y, 255})
                    frame.rgba.own().push_back(static_cast<std::uint8_t>(value));
                if (drawing.depth)
                    frame.depth.own().push_back(static_cast<float>(x) + static_cast<float>(y) * 0.5f);
            }
        }
        frame.stats.add("nearest", 1);
        return frame;
    }

    std::vector<Window> windows;
    std::vector<glm::dvec2> jitter;
    std::vector<Pass> passes;
    ColorRule color;
    std::uint64_t cutSamples = 0;
    bool mirrors = false;
    std::int64_t atOnce = 0;
    std::size_t reflections = 0, regionsDropped = 0;
};

/// One leaf of four samples at the corners of a 2 × 2 square around the origin, far from file zero.
Cloud fourPoints() {
    Cloud cloud;
    cloud.origin = {500'000, 4'000'000, 100};
    cloud.bounds = {cloud.origin + glm::dvec3(-1, -1, 0), cloud.origin + glm::dvec3(1, 1, 2)};
    cloud.points = 4;
    cloud.attributes.intensity = true;
    cloud.intensityRange = {10, 200};
    cloud.spacing = 1;
    Node node{};
    node.boxMin = {-1, -1, 0};
    node.boxMax = {1, 1, 2};
    node.step = glm::dvec3(2.0 / 65535);
    node.center = {0, 0, 1};
    node.radius = 2;
    node.spacing = node.meanSpacing = 1;
    node.sampleCount = 4;
    node.points = 4;
    std::vector<Sample> samples(4);
    for (std::size_t i = 0; i < 4; ++i) {
        samples[i].x = i & 1 ? 65535 : 0;
        samples[i].y = i & 2 ? 65535 : 0;
    }
    cloud.octree = Octree({node}, samples);
    return cloud;
}

View fromAbove(const Cloud& cloud, int width = 64, int height = 48) {
    View view;
    view.width = width;
    view.height = height;
    view.camera.eye = cloud.origin + glm::dvec3(0, -5, 5);
    view.camera.target = cloud.origin;
    view.style.color = ColorSource::Elevation;
    return view;
}

// A cloud whose colours are all the same is not shown in them, unless they are asked for.
TEST(Render, WhatIsTheSameEverywhereIsLeftOutUnlessAskedFor) {
    Cloud cloud = fourPoints();
    View view = defaultView(cloud);
    EXPECT_EQ(plan(cloud, view).value()->colorName, "intensity");
    cloud.attributes.intensity = false;
    EXPECT_EQ(plan(cloud, view).value()->colorName, "elevation");
    view.style.color = ColorSource::Rgb;
    EXPECT_FALSE(checkView(cloud, view)) << "there are none";
    cloud.constant.color = Rgb8{0, 0, 0};
    NotingDevice device;
    const auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.color.source, ColorSource::Rgb);
    cloud.constant.intensity = 65535;
    cloud.intensityRange = {65535, 65535};
    view.style.color = ColorSource::Intensity;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_EQ(device.color.low, 65535);
    EXPECT_GT(device.color.high, device.color.low);
}

TEST(Render, InfraredIsDrawnOfCloudsThatHaveIt) {
    Cloud cloud = fourPoints();
    View view = fromAbove(cloud, 64, 48);
    view.style.color = ColorSource::Infrared;
    const auto none = checkView(cloud, view);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::Unsupported);
    EXPECT_EQ(none.error().field, "color");
    EXPECT_EQ(none.error().message,
              "this cloud has no near infrared to colour by; it has intensity, elevation, depth, lod, cloud "
              "and #rrggbb");
    cloud.companions = {nearInfraredPlane()};
    view.style.exposure = 1;
    NotingDevice device;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_EQ(device.color.source, ColorSource::Infrared);
    EXPECT_EQ(device.color.ramp[255], (Rgb8{255, 255, 255}));
    EXPECT_GT(device.color.ramp[100][0], 100) << "it has an exposure";
    EXPECT_TRUE(plan(cloud, view).value()->beside);
    view.style.color = ColorSource::Intensity;
    EXPECT_FALSE(plan(cloud, view).value()->beside);
}

TEST(Render, HiddenPointsAreShownByWhoRemovesThem) {
    const Cloud cloud = fourPoints();
    View view = fromAbove(cloud, 64, 48);
    view.style.color = ColorSource::Visibility;
    for (const Method& method : methods()) {
        view.style.method = method.name;
        const auto ok = checkView(cloud, view);
        if (method.needs == Needs::Surfels) continue;  // refused for that
        EXPECT_EQ(ok.has_value(), method.name == "pyramid") << method.name;
        if (ok) continue;
        EXPECT_EQ(ok.error().field, "color");
        EXPECT_THAT(ok.error().message, HasSubstr("use method=pyramid"));
    }
    view.style.method = "pyramid";
    view.style.shading = Shading::Phong;
    view.style.light.occlusion = 1;
    NotingDevice device;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_EQ(device.color.source, ColorSource::Flat) << "devices know no labels' colours but the pass's";
    ASSERT_EQ(device.passes.size(), 4u) << "neither filled nor lit";
    EXPECT_TRUE(std::holds_alternative<VisibilityPass>(device.passes.back()));
    EXPECT_EQ(plan(cloud, view).value()->colorName, "visibility");
}

TEST(Render, APosterIsDrawnInTilesThatFitTogether) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud, 5000, 2500);
    view.style.shading = Shading::EyeDome;
    const auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.windows.size(), 6u);
    for (const auto& window : device.windows) {
        EXPECT_LE(window.width, 2048 + 16);
        EXPECT_TRUE(window.x >= 0 && window.y >= 0 && window.x + window.width <= 5000 &&
                    window.y + window.height <= 2500);
    }
    // Every pixel must hold the value of its own place.
    for (int y = 0; y < 2500; y += 7) {
        for (int x = 0; x < 5000; x += 3) {
            const auto i = static_cast<std::size_t>(y) * 5000 + static_cast<std::size_t>(x);
            ASSERT_EQ(frame->rgba[i * 4], static_cast<std::uint8_t>(x)) << x << ' ' << y;
            ASSERT_EQ(frame->rgba[i * 4 + 1], static_cast<std::uint8_t>(y)) << x << ' ' << y;
            ASSERT_EQ(frame->depth[i], static_cast<float>(x) + static_cast<float>(y) * 0.5f);
        }
    }
    // Eye-dome lighting looks at neighbours, so inner tiles are drawn with a margin.
    EXPECT_GT(device.windows[1].width, 2048);
}

TEST(Render, ADeviceThatCanDrawsAPosterInOnePiece) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud, 200, 120);
    const RenderOptions small{.tileSide = 64};
    const auto inTiles = render(device, cloud, view, small);
    EXPECT_EQ(device.windows.size(), 8u);
    for (const auto& [pixels, pieces] : {std::pair{200 * 120 - 1, 8u}, {200 * 120, 1u}}) {
        device.windows.clear();
        device.atOnce = pixels;
        const auto frame = render(device, cloud, view, small);
        ASSERT_TRUE(inTiles && frame);
        EXPECT_EQ(device.windows.size(), pieces);
        EXPECT_EQ(frame->rgba, inTiles->rgba);
        EXPECT_EQ(frame->depth, inTiles->depth);
    }
    // Its pyramid would show where tiles meet: the bytes would depend on the device's memory.
    device.windows.clear();
    view.style.method = "pyramid";
    ASSERT_TRUE(render(device, cloud, view, small));
    EXPECT_EQ(device.windows.size(), 8u);
}

TEST(Render, DepthIsOnlyDrawnWhereItIsAskedFor) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    for (const int width : {64, 2500}) {  // in one piece, and in tiles
        const View view = fromAbove(cloud, width, 48);
        const auto with = render(device, cloud, view),
                   without = render(device, cloud, view, {.depth = false});
        ASSERT_TRUE(with && without);
        EXPECT_EQ(with->depth.size() * 4, with->rgba.size());
        EXPECT_TRUE(without->depth.empty());
        EXPECT_EQ(without->rgba, with->rgba);
    }
}

TEST(Render, DevicesWithoutMirrorsDrawThePointsAsRecordedAndSaySo) {
    Cloud cloud = fourPoints();
    Mirror mirror;
    mirror.center = cloud.origin;
    mirror.normal = glm::normalize(glm::dvec3(0, -1, 1));
    mirror.up = glm::normalize(glm::dvec3(0, 1, 1));
    mirror.width = mirror.height = 1;
    cloud.mirrors = {mirror};
    NotingDevice device;
    View view = fromAbove(cloud);
    auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.reflections + device.regionsDropped, 0u);
    EXPECT_EQ(frame->stats.mirrorsDrawn, 0u);
    EXPECT_EQ(frame->stats.mirrorsLeftOut, 1u);
    device.mirrors = true;
    frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.reflections, 1u);
    EXPECT_EQ(device.regionsDropped, 1u);
    EXPECT_EQ(frame->stats.mirrorsDrawn, 1u);
    view.style.mirrors = false;
    view.style.behindMirrors = true;
    frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.reflections + device.regionsDropped, 0u);
    EXPECT_EQ(frame->stats.mirrorsDrawn + frame->stats.mirrorsLeftOut, 0u);
}

TEST(Render, AntiAliasingDoesNotMoveThePicture) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud);
    for (const int samples : {1, 4, 16}) {
        view.quality.samples = samples;
        ASSERT_TRUE(render(device, cloud, view));
        ASSERT_EQ(device.jitter.size(), static_cast<std::size_t>(samples));
        glm::dvec2 mean(0);
        for (const auto& shift : device.jitter) {
            EXPECT_LT(std::max(std::abs(shift.x), std::abs(shift.y)), 0.75);
            mean += shift;
        }
        EXPECT_NEAR(mean.x, 0, 1e-12);
        EXPECT_NEAR(mean.y, 0, 1e-12);
    }
    view.quality.samples.reset();
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_EQ(device.jitter.size(), 4u);
}

TEST(Render, ElevationRangeIsInFileCoordinates) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud);
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_NEAR(device.color.low, 0, 1e-9);
    EXPECT_NEAR(device.color.high, 2, 1e-9);
    view.style.range = {{100.5, 101.5}};
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_NEAR(device.color.low, 0.5, 1e-9);
    EXPECT_NEAR(device.color.high, 1.5, 1e-9);
}

TEST(Plan, TellsWhatTheRampsEndsStandForWhoeverChoseThem) {
    Cloud cloud = fourPoints();
    View view = fromAbove(cloud);
    const auto ends = [&](ColorSource color) {
        view.style.color = color;
        const auto planned = plan(cloud, view);
        return planned ? (*planned)->colorRange : std::nullopt;
    };
    EXPECT_EQ(ends(ColorSource::Intensity), (std::array{10.0, 200.0}));
    EXPECT_EQ(ends(ColorSource::Elevation), (std::array{100.0, 102.0}));
    EXPECT_EQ(ends(ColorSource::Lod), std::nullopt);
    const auto depth = ends(ColorSource::Depth);
    ASSERT_TRUE(depth);
    EXPECT_LT((*depth)[0], (*depth)[1]);
    view.style.range = {{100.5, 101.5}};
    EXPECT_EQ(ends(ColorSource::Elevation), view.style.range);
    cloud.attributes.classification = true;
    EXPECT_EQ(ends(ColorSource::Classification), std::nullopt) << "a range means nothing to classes";
}

TEST(Render, ColoursThatTheCloudLacksAreRefusedWithThoseItHas) {
    const Cloud cloud = fourPoints();
    View view = fromAbove(cloud);
    view.style.color = ColorSource::Rgb;
    const auto checked = checkView(cloud, view);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::Unsupported);
    EXPECT_EQ(checked.error().field, "color");
    EXPECT_THAT(checked.error().message, HasSubstr("intensity"));
}

TEST(Render, BrightnessFollowsTheCloudsIntensity) {
    Cloud cloud = fourPoints();
    View view = fromAbove(cloud);
    view.style.byIntensity = true;
    view.style.range = {100.5, 101.5};
    NotingDevice device;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_EQ(device.color.source, ColorSource::Elevation);
    EXPECT_NEAR(device.color.low, 0.5, 1e-9) << "the range is the elevation's";
    ASSERT_TRUE(device.color.byIntensity);
    EXPECT_EQ(device.color.byIntensity->low, 10);
    EXPECT_EQ(device.color.byIntensity->high, 200);
    EXPECT_LT(device.color.byIntensity->factors.front(), device.color.byIntensity->factors.back());
    cloud.intensityRange = {10, 10};
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_FALSE(device.color.byIntensity) << "what is the same everywhere makes nothing darker";
    cloud.attributes.intensity = false;
    const auto checked = checkView(cloud, view);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::Unsupported);
    EXPECT_EQ(checked.error().field, "color");
    EXPECT_THAT(checked.error().message, HasSubstr("no intensity"));
}

TEST(Render, OnlyTheCloudsOwnColoursAreExposed) {
    Cloud cloud = fourPoints();
    cloud.attributes.color = true;
    View view = defaultView(cloud);
    NotingDevice device;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_FALSE(device.color.toned) << "no stops, no work";
    view.style.exposure = 1;
    const auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_TRUE(device.color.toned);
    EXPECT_GT(device.color.ramp[100][1], 100);
    EXPECT_EQ(frame->stats.color, "rgb");
    EXPECT_EQ(frame->stats.exposure, 1);
    view.style.color = ColorSource::Intensity;
    ASSERT_TRUE(render(device, cloud, view));
    EXPECT_FALSE(device.color.toned);
}

TEST(Render, TheDefaultViewCanBeDrawn) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    const View view = defaultView(cloud, 320, 200);
    EXPECT_EQ(view.style.color, ColorSource::Auto);
    const auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(device.color.source, ColorSource::Intensity);
    EXPECT_EQ(frame->stats.color, "intensity");
    EXPECT_EQ(device.cutSamples, 4u);
    EXPECT_EQ(frame->stats.samplesDrawn, 4u);
    EXPECT_EQ(frame->stats.stages.front().name, "select");
}

TEST(Render, UnknownMethodNamesTheKnownOnes) {
    const Cloud cloud = fourPoints();
    View view = fromAbove(cloud);
    view.style.method = "splat";
    const auto checked = checkView(cloud, view);
    ASSERT_FALSE(checked);
    EXPECT_THAT(checked.error().message, HasSubstr("paraboloid"));
}

TEST(Render, EveryMethodDrawsWithItsDefaults) {
    Cloud cloud = fourPoints();
    cloud.surfels = true;
    NotingDevice device;
    for (const auto& method : methods()) {
        View view = fromAbove(cloud);
        view.style.method = method.name;
        const auto frame = render(device, cloud, view);
        ASSERT_TRUE(frame) << method.name << ": " << frame.error().message;
        EXPECT_FALSE(device.passes.empty());
    }
}

TEST(Render, MethodsThatNeedSurfelsSayHowToGetThem) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    int refused = 0;
    for (const auto& method : methods()) {
        View view = fromAbove(cloud);
        view.style.method = method.name;
        const auto frame = render(device, cloud, view);
        EXPECT_EQ(frame.has_value(), method.needs == Needs::Points) << method.name;
        if (frame) continue;
        ++refused;
        EXPECT_EQ(frame.error().code, ErrorCode::Unsupported);
        EXPECT_EQ(frame.error().field, "method");
        EXPECT_THAT(frame.error().message, HasSubstr("scancast ingest"));
    }
    EXPECT_GE(refused, 3);
}

TEST(Render, SilhouettesNeedASideAndSaySo) {
    Cloud cloud = fourPoints();
    cloud.surfels = true;
    View view = fromAbove(cloud);
    view.style.method = "voronoi";
    view.style.parameters["silhouette"] = true;
    const auto checked = checkView(cloud, view);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::Unsupported);
    EXPECT_EQ(checked.error().field, "param.silhouette");
    EXPECT_THAT(checked.error().message, HasSubstr("--orient up"));
    cloud.sides.emplace();
    EXPECT_TRUE(checkView(cloud, view));
    cloud.sides.reset();
    cloud.oriented = true;
    EXPECT_TRUE(checkView(cloud, view));
}

TEST(Render, LightNeedsNormalsUnlessTheMethodMakesThem) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud);
    view.style.shading = Shading::Phong;
    const auto frame = render(device, cloud, view);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().field, "shading");
    EXPECT_THAT(frame.error().message, HasSubstr("pyramid"));
    view.style.method = "pyramid";
    EXPECT_TRUE(render(device, cloud, view));
}

TEST(Render, AutoSaysWhatItChoseAndWhyAndStaysWithItAtAnyDistance) {
    Cloud cloud = fourPoints();
    NotingDevice device;
    View view = fromAbove(cloud);
    view.style.method = "auto";
    const auto chosen = [&](bool surfels, bool colors) {
        cloud.surfels = surfels;
        cloud.attributes.color = colors;
        const auto frame = render(device, cloud, view);
        if (!frame) return "refused: " + frame.error().message;
        EXPECT_THAT(frame->stats.methodReason, HasSubstr(colors ? "coloured" : "without colours"));
        return frame->stats.method;
    };
    for (const double height : {1.0, 1e6}) {  // from a unit apart to all four points on a pixel
        view.camera.viewHeight = height;
        view.camera.projection = Projection::Orthographic;
        EXPECT_EQ(chosen(true, true), "paraboloid")
            << "blended, what was photographed would lose its texture";
        EXPECT_EQ(chosen(true, false), "voronoi");
        EXPECT_EQ(chosen(false, true), "paraboloid");
        EXPECT_EQ(chosen(false, false), "paraboloid");
    }
    view.style.method = "paraboloid";
    const auto frame = render(device, cloud, view);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stats.method, "paraboloid");
    EXPECT_EQ(frame->stats.methodReason, "") << "nobody left it open";
}

TEST(Plan, AutoLightsWhatHasNoColours) {
    Cloud cloud = fourPoints();
    View view = fromAbove(cloud);
    view.style.method = "auto";
    const auto lit = [&](bool surfels, bool colors) {
        cloud.surfels = surfels;
        cloud.attributes.color = colors;
        const auto planned = plan(cloud, view).value();
        const auto has = [&](auto kind) {
            return std::ranges::any_of(planned->passes, [](const Pass& pass) {
                return std::holds_alternative<decltype(kind)>(pass);
            });
        };
        return std::string(has(PhongPass{}) ? "phong" : has(EyeDomePass{}) ? "eyedome" : "unlit");
    };
    EXPECT_EQ(lit(true, true), "unlit");
    EXPECT_EQ(lit(true, false), "phong");
    EXPECT_EQ(lit(false, false), "eyedome");
    view.style.shading = Shading::Unlit;
    EXPECT_EQ(lit(false, false), "unlit") << "the view's own word wins";
}

TEST(Plan, OcclusionLeftOpenIsTheLooksWithItsLight) {
    Cloud cloud = fourPoints();
    cloud.look.emplace().style.light.occlusion = 0.75;
    View view = fromAbove(cloud);
    const auto strength = [&] {
        const auto planned = plan(cloud, view).value();
        for (const Pass& pass : planned->passes)
            if (const auto* occlusion = std::get_if<OcclusionPass>(&pass)) return occlusion->strength;
        return 0.0f;
    };
    EXPECT_EQ(strength(), 0.75f);
    view.style.light.occlusion = 0.25;
    EXPECT_EQ(strength(), 0.25f) << "the view's own word wins";
    view.style.light.occlusion.reset();
    view.style.shading = Shading::EyeDome;
    EXPECT_EQ(strength(), 0.0f) << "another light, without it";
    view.style.shading.reset();
    view.style.method = "paraboloid";
    EXPECT_EQ(strength(), 0.0f) << "another method brings its own light";
}

TEST(Render, AnAbandonedFrameIsCancelled) {
    const Cloud cloud = fourPoints();
    NotingDevice device;
    std::stop_source stop;
    stop.request_stop();
    const auto frame = render(device, cloud, fromAbove(cloud), {}, stop.get_token());
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace scancast
