// What a mirror does besides reflecting, method by method: it hides and is hidden, has a depth, shows nothing
// from behind, and is the same in every tile, on any number of threads and any SIMD level.
#include <gtest/gtest.h>

#include <cstdlib>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "tests/oracle/mirror/draw_mirrored.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast {
namespace {

using namespace test;

constexpr glm::dvec2 twoFrames[] = {{0.25, -0.125}, {-0.25, 0.125}};

class MirrorRules : public OnDevice {
  protected:
    const MirroredRoom room_{0.03, 0.09};
    const AnalyticCloud cloud_{room_.points, room_.spacing};

    Frame drawWithout(const Method& method, const Viewpoint& view) const {
        const MethodScene scene(room_, method, view, cloud_.cut());
        return mustDraw(*device_, scene.drawing);
    }
    Frame drawWith(const Method& method, const Viewpoint& view) const {
        MethodScene scene(room_, method, view, cloud_.cut());
        const auto reflections = reflectionsFor(room_, view, cloud_.cut());
        scene.drawing.add(reflections);
        return mustDraw(*device_, scene.drawing);
    }
};

SCANCAST_ON_DEVICES(MirrorRules, "egl");

/// Colours of sprites need no neighbours, so the rules hold pixel by pixel: a scene nearer than the glass
/// stays as it was, all else is the glass, at its own depth.
TEST_P(MirrorRules, WhatStandsBeforeItHidesIt) {
    for (const char* name : {"paraboloid", "point", "hqs", "square"}) {
        const Method& method = *findMethod(name);
        for (const Setting& setting : settings(room_, slow_)) {
            const Frame before = drawWithout(method, setting.view), with = drawWith(method, setting.view);
            const GlassPixels glass = glassOf(room_.mirror, setting.view);
            const PixelMask inside = eroded(glass.mask, setting.view.width, setting.view.height, 1);
            int hidden = 0, seen = 0, wrong = 0;
            for (std::size_t i = 0; i < inside.size(); ++i) {
                const double distance = before.depth[i] - (glass.depth[i] - 2 * room_.spacing);
                if (!inside[i] || std::abs(distance) < 1e-4) continue;
                const bool kept = before.depth[i] == with.depth[i] &&
                                  std::equal(&before.rgba[4 * i], &before.rgba[4 * i] + 4, &with.rgba[4 * i]);
                const bool isGlass = std::abs(with.depth[i] - glass.depth[i]) < 1e-5 * glass.depth[i];
                (distance < 0 ? hidden : seen) += 1;
                wrong += distance < 0 ? !kept : !isGlass;
            }
            EXPECT_EQ(wrong, 0) << name << ", " << setting.name;
            EXPECT_GT(seen, 1000) << name << ", " << setting.name;
            // Elsewhere nothing stands before it.
            if (std::string(setting.name) == "from the back" || std::string(setting.name) == "near") {
                EXPECT_GT(hidden, 20) << name << ", " << setting.name;
            }
        }
    }
}

TEST_P(MirrorRules, NothingChangesOutsideTheGlass) {
    const Method& method = *findMethod("ewa");
    for (const Setting& setting : settings(room_, slow_)) {
        const Frame before = drawWithout(method, setting.view), with = drawWith(method, setting.view);
        const GlassPixels glass = glassOf(room_.mirror, setting.view);
        PixelMask outside = glass.mask;
        for (auto& m : outside) m = m == 0;
        // Eye-dome lighting and the like look a little further.
        outside = eroded(outside, setting.view.width, setting.view.height, 3);
        EXPECT_EQ(changedPixels(before, with, 0, outside).value(), 0) << setting.name;
    }
}

TEST(Mirrors, FromBehindOrOutOfViewThereIsNone) {
    const Cloud cloud = cloudOf(MirroredRoom(0.03, 0.09));
    const auto seen = [&](const Viewpoint& view) { return reflectionsIn(cloud, view, {}).size(); };
    EXPECT_EQ(seen(lookAt({0.2, 1.0, 1.3}, {0.2, 2, 1.3}, 100, 100)), 1u);
    EXPECT_EQ(seen(lookAt({0.2, 3.0, 1.3}, {0.2, 2, 1.3}, 100, 100)), 0u) << "from behind";
    EXPECT_EQ(seen(lookAt({0.2, 2.0, 1.3}, {0.2, 3, 1.3}, 100, 100)), 0u) << "in its plane";
    EXPECT_EQ(seen(lookAt({0.2, 1.0, 1.3}, {0.2, 0, 1.3}, 100, 100)), 0u) << "behind the eye";
    EXPECT_EQ(seen(lookAt({0.2, 1.0, 1.3}, {1.8, 1.1, 1.3}, 100, 100, 20)), 0u) << "beside the picture";
    EXPECT_EQ(seen(lookAt({0.2, 0, 1.3}, {0.2, 2, 1.3}, 100, 100, 60, 1e-3, 1.5)), 0u) << "beyond far";
    EXPECT_EQ(seen(lookAt({0.2, 0, 1.3}, {0.2, 2, 1.3}, 100, 100, 60, 2.5)), 0u) << "before near";
    EXPECT_EQ(seen(lookAtOrthographic({0.2, 3, 1.3}, {0.2, 2, 1.3}, 100, 100, 3)), 0u) << "parallel, behind";
    EXPECT_EQ(seen(lookAtOrthographic({0.2, 0, 1.3}, {0.2, 2, 1.3}, 100, 100, 3)), 1u);
}

/// By definition: the pyramid behind the rectangle that opens by 45°, and nothing else.
TEST_P(MirrorRules, PointsRecordedBehindItAreDropped) {
    Numbers numbers(5);
    std::vector<AnalyticPoint> all = room_.points, kept = room_.points;
    for (int i = 0; i < 20000; ++i) {
        AnalyticPoint p = room_.points[0];
        p.position = {numbers.uniform(-5, 5), numbers.uniform(2.01, 5), numbers.uniform(-3, 5)};
        const double opening = p.position.y - 2;
        const double outside =
            std::max(std::abs(p.position.x - 0.2) - 0.8, std::abs(p.position.z - 1.3) - 0.6);
        if (std::abs(outside - opening) < 1e-3) continue;  // nearer than samples are exact
        all.push_back(p);
        if (outside > opening) kept.push_back(p);
    }
    ASSERT_LT(kept.size() + 2000, all.size());
    ASSERT_GT(kept.size(), room_.points.size() + 2000);
    // Pixels, so that the clouds' own ways of dividing points into leaves change nothing.
    const Method& method = *findMethod("point");
    const AnalyticCloud withGhosts(all, room_.spacing), without(kept, room_.spacing);
    const Viewpoint outdoors = lookAt({1, 6, 4}, {0, 2, 1}, 320, 240);
    MethodScene dropped(room_, method, outdoors, withGhosts.cut());
    dropped.drawing.view().filter.dropped = behindMirrors(cloudOf(room_));
    const MethodScene built(room_, method, outdoors, without.cut());
    const MethodScene raw(room_, method, outdoors, withGhosts.cut());
    const Frame truth = mustDraw(*device_, built.drawing);
    EXPECT_LE(changedPixels(mustDraw(*device_, dropped.drawing), truth, 0).value(), 0.002);
    EXPECT_GE(changedPixels(mustDraw(*device_, raw.drawing), truth, 0).value(), 0.02);
}

TEST_P(MirrorRules, TilesContinueEachOther) {
    const Setting setting = settings(room_)[1];
    for (const Method& method : methods()) {
        if (method.name == "pyramid") continue;  // its tiles agree as its pictures without mirrors do
        MethodScene scene(room_, method, setting.view, cloud_.cut());
        const auto reflections = reflectionsFor(room_, setting.view, cloud_.cut());
        scene.drawing.add(reflections);
        const Frame whole = mustDraw(*device_, scene.drawing);
        const Window parts[] = {{0, 0, 231, 480}, {231, 0, 249, 200}, {231, 200, 249, 280}};
        for (const Window& part : parts) {
            scene.drawing.window = part;
            const Frame tile = mustDraw(*device_, scene.drawing);
            int wrong = 0;
            for (int y = 0; y < part.height; ++y)
                for (int x = 0; x < part.width; ++x)
                    wrong += pixel(tile, x, y) != pixel(whole, x + part.x, y + part.y) ||
                             depth(tile, x, y) != depth(whole, x + part.x, y + part.y);
            // Eye-dome lighting and the like know nothing beyond a tile drawn without its margin.
            const bool looksAround = method.defaultShading == Shading::EyeDome;
            EXPECT_LE(wrong, looksAround ? 8 * (part.width + part.height) : 0) << method.name;
        }
    }
}

TEST(Mirrors, AreTheSameBytesOnAnyThreadsAndSimdLevel) {
    const MirroredRoom room(0.03, 0.09);
    const AnalyticCloud cloud(room.points, room.spacing);
    const auto device = createCpuDevice(2).value();
    const Viewpoint view = lookAt(room.at({0.6, 0.7, 1.5}), room.at({0.1, 2, 1.3}), 333, 251);
    for (const Method& method : methods()) {
        MethodScene scene(room, method, view, cloud.cut());
        const auto reflections = reflectionsFor(room, view, cloud.cut());
        scene.drawing.add(reflections);
        scene.drawing.jitter = twoFrames;
        const Frame expected = mustDraw(*device, scene.drawing);
        for (const char* level : {"v2", "v3", "v4"}) {
            if (!cpu::chooseSimdLevel(level)) continue;
            setenv("SCANCAST_SIMD", level, 1);
            const auto other = createCpuDevice(1);
            unsetenv("SCANCAST_SIMD");
            ASSERT_TRUE(other) << other.error().message;
            const Frame frame = mustDraw(**other, scene.drawing);
            EXPECT_EQ(frame.rgba, expected.rgba) << method.name << ", " << level;
            EXPECT_EQ(frame.depth, expected.depth) << method.name << ", " << level;
        }
    }
}

/// Transparent stays transparent: nothing is behind the glass either.
TEST_P(MirrorRules, AnEmptyRoomIsReflectedAsBackground) {
    const Method& method = *findMethod("paraboloid");
    const AnalyticCloud empty(std::span<const AnalyticPoint>{}, room_.spacing);
    const Viewpoint view = settings(room_)[0].view;
    MethodScene scene(room_, method, view, empty.cut());
    const auto reflections = reflectionsFor(room_, view, empty.cut());
    scene.drawing.add(reflections);
    scene.drawing.background.top = {100, 200, 51};
    const GlassPixels glass = glassOf(room_.mirror, view);
    const PixelMask inside = eroded(glass.mask, view.width, view.height, 1);
    const auto check = [&](Rgb8 color, std::uint8_t opacity) {
        const Frame frame = mustDraw(*device_, scene.drawing);
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                if (!inside[std::size_t(y) * std::size_t(view.width) + std::size_t(x)]) continue;
                ASSERT_EQ(pixel(frame, x, y), color);
                ASSERT_EQ(alpha(frame, x, y), opacity);
            }
    };
    check({94, 196, 40}, 255);  // 100 · 240/255, 200 · 250/255, 51 · 200/255
    scene.drawing.background.kind = Background::Kind::Transparent;
    check({0, 0, 0}, 0);
}

}  // namespace
}  // namespace scancast
