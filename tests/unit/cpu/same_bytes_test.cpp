// The device's promise: the same request gives the same bytes on any number of threads and any SIMD level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/draw_surfels.hpp"
#include "tests/support/sized.hpp"

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

/// Colour by intensity, twice, a class filter, a clip box, eye-dome lighting and two averaged frames: all kernels
/// run.
Frame drawEverything(Device& device, const AnalyticCloud& cloud, const NearestPass& pass) {
    const Viewpoint view = lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171);
    Scene scene(view, cloud.cut(), pass);
    scene.addEyeDome();
    scene.add(OcclusionPass{0.8f, 15});
    OwnDrawing& d = scene.drawing;
    d.color.source = ColorSource::Intensity;
    d.color.high = 65535;
    d.color.byIntensity = factors(3000, 62000);
    for (std::size_t i = 0; i < 256; ++i)
        d.color.ramp[i] = {std::uint8_t(i), std::uint8_t(i * 7), std::uint8_t(255 - i)};
    d.view().filter.classes.emplace().fill(true);
    (*d.view().filter.classes)[3] = false;
    d.view().filter.clip = ClipBox{{-2, -2, -0.8}, {2, 2, 0.9}};
    d.background = Background{};
    const glm::dvec2 jitter[] = {{0.25, -0.1}, {-0.25, 0.4}};
    d.jitter = jitter;
    return mustDraw(device, d);
}

/// Surfels of every kind, some of them large, and many on top of each other so that sums overflow.
AnalyticCloud surfelCloud() {
    Numbers numbers(4);
    std::vector<AnalyticPoint> points(9000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        AnalyticPoint& p = points[i];
        p.position = numbers.onSphere() * numbers.uniform(0.7, 1.0);
        if (i % 3 == 0) p.position = {0, -0.9, 0.3};
        p.rgb = numbers.color();
        p.intensity = static_cast<std::uint16_t>(numbers.next());
        p.classification = static_cast<std::uint8_t>(numbers.next() % 20);
        const double radius = 0.02 * std::exp2(numbers.uniform(-2, 3));
        p.surfel =
            surfelOf(numbers.onSphere(), radius, glm::normalize(numbers.onSphere()), numbers.uniform(0.2, 1));
        if (i % 17 == 0) p.surfel->radius = 0;
        if (i % 19 == 0) p.surfel->normal = glm::vec3(0);
        p.surfel->outlier = i % 23 == 0;
    }
    return {points, 0.03, 1000};
}

/// Every list of passes of the methods that draw surfels.
std::vector<std::pair<std::string, PassList>> everySurfelMethod() {
    std::vector<std::pair<std::string, PassList>> lists;
    const auto add = [&](const char* name, const ParameterValues& given) {
        const Method& method = *findMethod(name);
        const ParameterValues values = resolveParameters(method, given).value();
        for (const Shading shading : {Shading::Unlit, Shading::Phong, Shading::EyeDome})
            lists.emplace_back(name, method.passes({method, values, shading}));
    };
    add("disc", {});
    add("disc", {{"scale", 0.1}, {"cull", false}});
    add("disc", {{"scale", 8.0}, {"maxPx", 40.0}});
    add("ewa", {});
    add("ewa", {{"scale", 0.3}, {"lowPass", 2.0}});
    for (const bool smooth : {false, true}) add("voronoi", {{"smooth", smooth}, {"silhouette", smooth}});
    return lists;
}

Frame drawSurfels(Device& device, const Cut& cut, const PassList& passes, bool oriented, Window window,
                  bool perspective = true) {
    const Viewpoint view = perspective ? lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171)
                                       : lookAtOrthographic({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171, 2.3);
    SurfelScene scene(view, cut, passes);
    scene.drawing.oriented = oriented;
    scene.drawing.background = Background{};
    scene.drawing.window = window;
    const glm::dvec2 jitter[] = {{0.25, -0.1}, {-0.25, 0.4}};
    scene.drawing.jitter = jitter;
    return mustDraw(device, scene.drawing);
}

constexpr Window everything{0, 0, 233, 171};
constexpr Window quarters[] = {{0, 0, 100, 60}, {100, 0, 133, 60}, {0, 60, 100, 111}, {100, 60, 133, 111}};

struct SimdVariable {
    explicit SimdVariable(const char* value) { setenv("SCANCAST_SIMD", value, 1); }
    ~SimdVariable() { unsetenv("SCANCAST_SIMD"); }
};

/// One as it comes, and of each SIMD level that there is one for each number of threads.
std::vector<std::unique_ptr<Device>> devicesOfEveryLevel(std::initializer_list<int> threadCounts) {
    std::vector<std::unique_ptr<Device>> devices;
    devices.push_back(createCpuDevice(1).value());
    for (const cpu::SimdLevel& level : cpu::simdLevels()) {
        if (!level.available()) continue;
        const SimdVariable forced(std::string(level.name).c_str());
        for (const int threads : threadCounts) devices.push_back(createCpuDevice(threads).value());
    }
    return devices;
}

TEST(SameBytes, OnAnyNumberOfThreadsAndAnySimdLevel) {
    const AnalyticCloud cloud = mixedCloud();
    const std::vector<std::unique_ptr<Device>> devices = devicesOfEveryLevel({1, 2, 5});
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

TEST(SameBytes, WithWhatIsKnownOfSamplesAndWithout) {
    // Right because limits only say what lies elsewhere or is hidden: nothing that shows.
    const AnalyticCloud cloud = surfelCloud();
    Cut known = cloud.cut();
    std::vector<std::vector<SampleLimits>> limits;
    for (const CutRun& run : known.runs) limits.push_back(limitsOf(run.samples));
    for (std::size_t i = 0; i < limits.size(); ++i) known.runs[i].limits = limits[i];
    const auto device = createCpuDevice(2).value();
    auto lists = everySurfelMethod();
    for (const char* name : {"paraboloid", "square", "point", "hqs"}) {
        const Method& method = *findMethod(name);
        const ParameterValues values = resolveParameters(method, {}).value();
        lists.emplace_back(name, method.passes({method, values, Shading::Unlit}));
    }
    for (const auto& [name, passes] : lists) {
        for (const bool perspective : {true, false}) {
            const Frame without = drawSurfels(*device, cloud.cut(), passes, false, everything, perspective);
            const Frame with = drawSurfels(*device, known, passes, false, everything, perspective);
            ASSERT_EQ(without.rgba, with.rgba) << name;
            ASSERT_EQ(0, std::memcmp(without.depth.data(), with.depth.data(), with.depth.size() * 4)) << name;
        }
    }
}

TEST(SameBytes, OfSurfelsOnAnyNumberOfThreadsAndAnySimdLevel) {
    const AnalyticCloud cloud = surfelCloud();
    const std::vector<std::unique_ptr<Device>> devices = devicesOfEveryLevel({1, 2});
    for (const auto& [name, passes] : everySurfelMethod()) {
        for (const bool oriented : {false, true}) {
            for (const bool perspective : {true, false}) {
                if (test::sanitized && oriented != perspective) continue;
                const Frame first =
                    drawSurfels(*devices[0], cloud.cut(), passes, oriented, everything, perspective);
                for (std::size_t i = 1; i < devices.size(); ++i) {
                    const Frame other =
                        drawSurfels(*devices[i], cloud.cut(), passes, oriented, everything, perspective);
                    ASSERT_EQ(first.rgba, other.rgba) << devices[i]->info().renderer << ", " << name;
                    ASSERT_EQ(0, std::memcmp(first.depth.data(), other.depth.data(), first.depth.size() * 4));
                }
            }
        }
    }
}

TEST(SameBytes, OfSurfelsHoweverTheCutIsDividedWholeOrInWindows) {
    const AnalyticCloud cloud = surfelCloud();
    Cut reversed = cloud.cut();
    std::ranges::reverse(reversed.runs);
    std::uint32_t ordinal = 0;
    for (CutRun& run : reversed.runs) {
        run.firstOrdinal = ordinal;
        ordinal += static_cast<std::uint32_t>(run.samples.size());
    }
    const auto device = createCpuDevice(2).value();
    for (const auto& [name, passes] : everySurfelMethod()) {
        const Frame whole = drawSurfels(*device, cloud.cut(), passes, true, everything);
        // Where samples coincide, which of them shows is a matter of ordinals; but blended it is not.
        const bool blended = name == "ewa" && !std::holds_alternative<PhongPass>(passes.back());
        if (blended) {
            ASSERT_EQ(whole.rgba, drawSurfels(*device, reversed, passes, true, everything).rgba) << name;
        }
        for (const Window& w : quarters) {
            const Frame part = drawSurfels(*device, cloud.cut(), passes, true, w);
            for (int y = 0; y < w.height; ++y) {
                for (int x = 0; x < w.width; ++x) {
                    ASSERT_EQ(pixel(part, x, y), pixel(whole, w.x + x, w.y + y)) << name;
                    ASSERT_EQ(depth(part, x, y), depth(whole, w.x + x, w.y + y)) << name;
                }
            }
        }
    }
}

TEST(SameBytes, OfSmoothedBordersOnAnyThreadsAndSimdLevelWholeOrInWindows) {
    const AnalyticCloud cloud = mixedCloud();
    const std::vector<std::unique_ptr<Device>> devices = devicesOfEveryLevel({1, 3});
    const Viewpoint views[] = {lookAt({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171),
                               lookAtOrthographic({0.4, -1.9, 0.6}, {0, 0, 0}, 233, 171, 2.3)};
    for (const Viewpoint& view : views) {
        for (const float px : {0.0f, 0.5f, 3.3f, 30.0f}) {
            NearestPass pass =
                sprite(px == 3.3f ? Footprint::Square : Footprint::Circle, Profile::Paraboloid, px);
            const Frame hard = mustDraw(*devices[0], Scene(view, cloud.cut(), pass).drawing);
            pass.payload = Payload::Sample;
            Scene scene(view, cloud.cut(), pass);
            std::get<ResolvePass>(scene.passes[1]).smooth = true;
            const Frame whole = mustDraw(*devices[0], scene.drawing);
            EXPECT_NE(whole.rgba, hard.rgba) << px;
            EXPECT_EQ(whole.depth, hard.depth) << px;
            for (const auto& device : devices)
                ASSERT_EQ(whole.rgba, mustDraw(*device, scene.drawing).rgba) << device->info().renderer;
            for (const Window& w : quarters) {
                scene.drawing.window = w;
                const Frame part = mustDraw(*devices.back(), scene.drawing);
                for (int y = 0; y < w.height; ++y)
                    for (int x = 0; x < w.width; ++x)
                        ASSERT_EQ(pixel(part, x, y), pixel(whole, w.x + x, w.y + y)) << px;
            }
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
            if (lit) scene.add(OcclusionPass{0.8f, 31.4f});
            scene.drawing.background = Background{};
            const Frame whole = mustDraw(*device, scene.drawing);
            for (const Window& w : quarters) {
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
