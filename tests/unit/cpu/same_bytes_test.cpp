// The device's promise: the same request gives the same bytes on any number of threads and any SIMD level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "tests/support/draw_cut.hpp"

namespace scancast::test {
namespace {

AnalyticCloud mixedCloud() {
    Numbers numbers(3);
    std::vector<AnalyticPoint> points(15000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * numbers.uniform(0.7, 1.0);
        p.rgb = numbers.color();
        p.intensity = static_cast<std::uint16_t>(numbers.next());
        p.classification = static_cast<std::uint8_t>(numbers.next() % 20);
    }
    return {points, 0.02, 1000};
}

std::vector<NearestPass> everySprite() {
    std::vector<NearestPass> passes{sprite(Footprint::Pixel, Profile::Flat, 1)};
    for (const Footprint footprint : {Footprint::Square, Footprint::Circle}) {
        for (const Profile profile : {Profile::Flat, Profile::Paraboloid, Profile::Cone, Profile::Sphere}) {
            for (const float px : {0.0f, 0.5f, 2.0f, 3.3f, 7.9f, 30.0f}) {
                passes.push_back(sprite(footprint, profile, px));
            }
        }
    }
    return passes;
}

/// Colour by intensity, a class filter, a clip box, eye-dome lighting and two averaged frames: all kernels
/// run.
Frame drawEverything(Device& device, const AnalyticCloud& cloud, const NearestPass& pass) {
    const Viewpoint view = lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171);
    Scene scene(view, cloud.cut(), pass);
    scene.addEyeDome();
    Drawing& d = scene.drawing;
    d.color.source = ColorSource::Intensity;
    d.color.high = 65535;
    for (std::size_t i = 0; i < 256; ++i)
        d.color.ramp[i] = {std::uint8_t(i), std::uint8_t(i * 7), std::uint8_t(255 - i)};
    d.filter.classes.emplace().fill(true);
    (*d.filter.classes)[3] = false;
    d.filter.clip = ClipBox{{-2, -2, -0.8}, {2, 2, 0.9}};
    d.background = Background{};
    const glm::dvec2 jitter[] = {{0.25, -0.1}, {-0.25, 0.4}};
    d.jitter = jitter;
    return mustDraw(device, d);
}

struct SimdVariable {
    explicit SimdVariable(const char* value) { setenv("SCANCAST_SIMD", value, 1); }
    ~SimdVariable() { unsetenv("SCANCAST_SIMD"); }
};

TEST(SameBytes, OnAnyNumberOfThreadsAndAnySimdLevel) {
    const AnalyticCloud cloud = mixedCloud();
    std::vector<std::unique_ptr<Device>> devices;
    devices.push_back(createCpuDevice(1).value());
    for (const cpu::SimdLevel& level : cpu::simdLevels()) {
        if (!level.available()) continue;
        const SimdVariable forced(std::string(level.name).c_str());
        for (const int threads : {1, 2, 5}) devices.push_back(createCpuDevice(threads).value());
    }
    ASSERT_GE(devices.size(), 4u);
    for (const NearestPass& pass : everySprite()) {
        const Frame first = drawEverything(*devices[0], cloud, pass);
        for (std::size_t i = 1; i < devices.size(); ++i) {
            const Frame other = drawEverything(*devices[i], cloud, pass);
            ASSERT_EQ(first.rgba, other.rgba)
                << devices[i]->info().renderer << ", " << pass.size.sizePx << " px";
            ASSERT_EQ(0, std::memcmp(first.depth.data(), other.depth.data(), first.depth.size() * 4))
                << devices[i]->info().renderer << ", " << pass.size.sizePx << " px";
        }
    }
}

TEST(SameBytes, WhateverWasDrawnBefore) {
    const AnalyticCloud cloud = mixedCloud();
    const auto device = createCpuDevice(2).value();
    const NearestPass pass = sprite(Footprint::Circle, Profile::Paraboloid, 4);
    const Frame first = drawEverything(*device, cloud, pass);
    drawEverything(*device, cloud, sprite(Footprint::Square, Profile::Flat, 30));
    EXPECT_EQ(first.rgba, drawEverything(*device, cloud, pass).rgba);
}

TEST(SameBytes, HoweverTheCutIsDivided) {
    // Runs of 1000 and of 77 samples hold the same points up to their quantisation, so compare one cut with
    // its runs in reverse: front-to-back order and ordinals change, the picture must not.
    const AnalyticCloud cloud = mixedCloud();
    Cut reversed = cloud.cut();
    std::ranges::reverse(reversed.runs);
    const Viewpoint view = lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171);
    const auto device = createCpuDevice(2).value();
    for (const NearestPass& pass : everySprite()) {
        Scene forth(view, cloud.cut(), pass), back(view, reversed, pass);
        ASSERT_EQ(mustDraw(*device, forth.drawing).rgba, mustDraw(*device, back.drawing).rgba);
    }
}

TEST(SameBytes, DrawnWholeOrInWindows) {
    const AnalyticCloud cloud = mixedCloud();
    const auto device = createCpuDevice(2).value();
    const Viewpoint view = lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171);
    for (const bool lit : {false, true}) {
        for (const NearestPass& pass : everySprite()) {
            Scene scene(view, cloud.cut(), pass);
            if (lit) scene.addEyeDome();
            scene.drawing.background = Background{};
            const Frame whole = mustDraw(*device, scene.drawing);
            for (const Window w : {Window{0, 0, 100, 60}, Window{100, 0, 133, 60}, Window{0, 60, 100, 111},
                                   Window{100, 60, 133, 111}}) {
                scene.drawing.window = w;
                const Frame part = mustDraw(*device, scene.drawing);
                for (int y = 0; y < w.height; ++y) {
                    for (int x = 0; x < w.width; ++x) {
                        ASSERT_EQ(pixel(part, x, y), pixel(whole, w.x + x, w.y + y)) << pass.size.sizePx;
                        ASSERT_EQ(depth(part, x, y), depth(whole, w.x + x, w.y + y));
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace scancast::test
