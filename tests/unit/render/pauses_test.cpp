// Pictures within the pauses of others have the bytes that they have alone, and so do those around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "renderer/method/method.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

/// Enough for a picture to take some slices; with mirrors.
std::shared_ptr<const Cloud> room() {
    static const std::shared_ptr<const Cloud> cloud = *sceneCloud("room", 300'000);
    return cloud;
}

struct Pictures {
    std::shared_ptr<const PreparedView> prepared;
    Frame alone;
};

class Pausing : public OnDevice {
  protected:
    static constexpr int tileSide = 256;  // of GL devices, which let others in between tiles only

    /// Lit and in shadow, where the method can.
    View viewOf(const std::string& method, int width, int samples) const {
        View view = defaultView(*room(), width, width * 5 / 8);
        view.style.method = method;
        view.style.shading = Shading::Phong;
        view.style.light.sun = {200.0, 40.0};
        view.style.light.shadow = 0.8;
        view.style.light.occlusion = 0.5;
        view.quality.samples = samples;
        if (!plan(*room(), view)) {
            view.style.shading.reset();
            view.style.light = {};
        }
        return view;
    }
    std::shared_ptr<const PreparedView> prepared(const View& view) {
        RenderOptions options;
        options.tileSide = device_->info().pauses ? largestTile : tileSide;
        return *prepare(*room(), *plan(*room(), view), options);
    }
    Expected<Frame> drawn(const PreparedView& view, const Pause* pause, std::stop_token stop = {}) {
        auto begun = beginDrawing(*device_, view, std::move(stop), Uploads::Everything, pause);
        if (!begun) return passOn(std::move(begun));
        return (*begun)->finish();
    }
    bool small() const { return slow_ || sanitized; }
    static bool same(const Frame& a, const Frame& b) {
        return std::ranges::equal(a.rgba, b.rgba) && std::ranges::equal(a.depth, b.depth);
    }
};

TEST_P(Pausing, ChangesNoByteOfAnyPicture) {
    const auto others = {"voronoi", "pyramid", "ewa", "paraboloid"};
    std::size_t which = 0;
    for (const Method& method : methods()) {
        if (small() && which > 2) break;
        const auto outer = prepared(viewOf(method.name, small() ? 400 : 900, 2));
        const auto middle = prepared(viewOf(std::data(others)[which++ % 4], small() ? 300 : 500, 1));
        const auto inner = prepared(viewOf("square", 64, 1));
        const Frame outerAlone = *drawn(*outer, nullptr), middleAlone = *drawn(*middle, nullptr),
                    innerAlone = *drawn(*inner, nullptr);
        int middles = 0, inners = 0, wrong = 0;
        const Pause drawInner = [&] {
            ++inners;
            wrong += !same(*drawn(*inner, nullptr), innerAlone);
        };
        const Pause drawMiddle = [&] {
            if (++middles > 4) return;
            wrong += !same(*drawn(*middle, &drawInner), middleAlone);
        };
        const auto paused = drawn(*outer, &drawMiddle);
        ASSERT_TRUE(paused) << paused.error().message;
        EXPECT_TRUE(same(*paused, outerAlone)) << method.name;
        EXPECT_EQ(wrong, 0) << "within " << method.name;
        EXPECT_GT(middles, 0) << method.name;
        if (method.name == std::string("ewa")) {
            EXPECT_GT(inners, 0);
        }
    }
}

TEST_P(Pausing, ATimeOfItsOwnIsToldByEachPicture) {
    const auto outer = prepared(viewOf("voronoi", small() ? 300 : 900, 2));
    const auto start = std::chrono::steady_clock::now();
    std::chrono::duration<double, std::milli> within{0};
    int waits = 0;
    const Pause wait = [&] {
        if (++waits > 20) return;
        const auto before = std::chrono::steady_clock::now();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        within += std::chrono::steady_clock::now() - before;
    };
    const auto frame = drawn(*outer, &wait);
    const std::chrono::duration<double, std::milli> all = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(frame);
    ASSERT_GT(within.count(), 0);
    double told = 0;
    for (const StageTime& stage : frame->stats.stages) {
        if (stage.name != "select" && stage.name != "provide") told += stage.milliseconds;  // were before
    }
    if (device_->info().pauses) {
        EXPECT_LE(told, (all - within).count());
    }
}

TEST_P(Pausing, WhatIsAbandonedMeanwhileEnds) {
    const auto outer = prepared(viewOf("ewa", small() ? 400 : 900, 4));
    std::stop_source stop;
    int pauses = 0;
    const Pause abandon = [&] {
        ++pauses;
        stop.request_stop();
    };
    const auto frame = drawn(*outer, &abandon, stop.get_token());
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(pauses, 1);
    EXPECT_TRUE(drawn(*outer, nullptr)) << "and leaves no trace";
}

/// Of devices that keep buffers for pictures within each other.
using PausingDeeply = Pausing;

TEST_P(PausingDeeply, TooManyWithinEachOtherAreRefused) {
    const auto view = prepared(viewOf("paraboloid", small() ? 400 : 900, 4));
    int depth = 0, deepest = 0, refused = 0;
    Pause deeper = [&] {
        if (refused > 0 || (deepest > 0 && depth == 0)) return;
        ++depth;
        deepest = std::max(deepest, depth);
        const auto frame = drawn(*view, &deeper);
        refused += !frame && frame.error().code == ErrorCode::ResourceLimit;
        --depth;
    };
    EXPECT_TRUE(drawn(*view, &deeper));
    EXPECT_EQ(deepest, 4);
    EXPECT_EQ(refused, 1);
}

SCANCAST_ON_DEVICES(Pausing, "egl");
INSTANTIATE_TEST_SUITE_P(Cpu, PausingDeeply, ::testing::Values("cpu"), deviceName);

}  // namespace
}  // namespace scancast::test
