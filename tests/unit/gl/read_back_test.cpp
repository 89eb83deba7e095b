// What is read back is lent from where it arrived: no copy of it, no buffer made that is not needed, nothing
// overwritten while somebody reads, and nothing gone before the last reader is.
#include "renderer/device/gl/memory/read_back.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <numeric>
#include <thread>

#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/gl_context_test.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::gl {
namespace {

class GlReadBack : public WithContext {
  protected:
    void SetUp() override {
        WithContext::SetUp();
        if (!context_) return;
        noting_.emplace(gl());
        readBack_.emplace(noting_->functions, context_);
    }
    void TearDown() override {
        readBack_.reset();
        WithContext::TearDown();
    }

    /// Words first, first + 1 …; depths half of them.
    std::unique_ptr<ReadBack::Transfer> start(std::uint32_t first, std::size_t pixels, bool depth = true) {
        std::vector<std::uint32_t> words(pixels);
        std::iota(words.begin(), words.end(), first);
        std::vector<float> depths(words.begin(), words.end());
        for (float& d : depths) d /= 2;
        Buffer colours(context_->functions(), "colours"), distances(context_->functions(), "depths");
        EXPECT_TRUE(colours.write(std::as_bytes(std::span(words))));
        EXPECT_TRUE(distances.write(std::as_bytes(std::span(depths))));
        auto started = readBack_->start(colours, depth ? &distances : nullptr, pixels);
        EXPECT_TRUE(started) << started.error().message;
        return started ? std::move(*started) : nullptr;
    }
    Pixels<std::uint8_t> arrived(std::uint32_t first, std::size_t pixels) {
        const auto transfer = start(first, pixels, false);
        EXPECT_TRUE(transfer->wait({}));
        return transfer->rgba();
    }
    static bool holds(const Pixels<std::uint8_t>& rgba, std::uint32_t first, std::size_t pixels) {
        if (rgba.size() != 4 * pixels) return false;
        for (std::uint32_t i = 0; i < pixels; ++i) {
            std::uint32_t word = 0;
            std::memcpy(&word, rgba.data() + 4 * i, 4);
            if (word != first + i) return false;
        }
        return true;
    }

    std::optional<NotedGl> noting_;
    std::optional<ReadBack> readBack_;
};
INSTANTIATE_TEST_SUITE_P(Gl, GlReadBack, testing::Values("egl", "osmesa"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

TEST_P(GlReadBack, LendsWhatIsMapped) {
    const auto transfer = start(5, 1000);
    ASSERT_TRUE(transfer->wait({}));
    EXPECT_TRUE(transfer->ready());
    const Pixels<std::uint8_t> rgba = transfer->rgba();
    const Pixels<float> depth = transfer->depth();
    EXPECT_TRUE(rgba.lent() && depth.lent());
    ASSERT_EQ(NotedGl::noted.mapped.size(), 1u);
    EXPECT_EQ(static_cast<const void*>(rgba.data()), NotedGl::noted.mapped[0]);
    EXPECT_EQ(static_cast<const void*>(depth.data()), rgba.data() + 4000);
    EXPECT_TRUE(holds(rgba, 5, 1000));
    ASSERT_EQ(depth.size(), 1000u);
    for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(depth[i], static_cast<float>(i + 5) / 2);
}

TEST_P(GlReadBack, NoDepthIsCopiedUnlessAskedFor) {
    auto transfer = start(0, 1000, false);
    ASSERT_TRUE(transfer->wait({}));
    EXPECT_TRUE(transfer->depth().empty());
    EXPECT_EQ(NotedGl::noted.copied, 4000);
    EXPECT_EQ(readBack_->bytes(), 4000u);
    transfer = start(0, 1000, true);
    EXPECT_EQ(NotedGl::noted.copied, 4000 + 8000);
}

TEST_P(GlReadBack, OneAfterTheOtherNeedsTwoBuffersAndNoMore) {
    Pixels<std::uint8_t> before;
    for (std::uint32_t i = 0; i < 50; ++i) {
        // As the scheduler does: one is being encoded while the next arrives.
        auto now = arrived(100 * i, 640 - i);
        EXPECT_TRUE(i == 0 || holds(before, 100 * (i - 1), 640 - (i - 1))) << i;
        EXPECT_TRUE(holds(now, 100 * i, 640 - i)) << i;
        before = std::move(now);
    }
    EXPECT_EQ(NotedGl::noted.created, 2);
    EXPECT_EQ(NotedGl::noted.deleted, 0);
}

TEST_P(GlReadBack, WhatIsLentIsNotOverwritten) {
    std::deque<Pixels<std::uint8_t>> frames;
    for (std::uint32_t i = 0; i < 6; ++i) frames.push_back(arrived(1000 * i, 512));
    for (std::uint32_t i = 0; i < 6; ++i) EXPECT_TRUE(holds(frames[i], 1000 * i, 512)) << i;
    const auto copy = frames[2];
    frames.clear();
    for (std::uint32_t i = 0; i < 5; ++i) EXPECT_TRUE(holds(arrived(7 * i, 512), 7 * i, 512)) << i;
    EXPECT_TRUE(holds(copy, 2000, 512)) << "a copy is a reader, too";
    EXPECT_EQ(NotedGl::noted.created, 6);
}

TEST_P(GlReadBack, WhatIsAbandonedIsFreeAgain) {
    for (std::uint32_t i = 0; i < 5; ++i) start(i, 300);
    EXPECT_EQ(NotedGl::noted.created, 1);
    EXPECT_TRUE(holds(arrived(77, 300), 77, 300));
}

TEST_P(GlReadBack, BuffersGrowWithThePictureAndAPosterOfOnceGoes) {
    constexpr std::size_t screen = ReadBack::smallSlot / 16, poster = ReadBack::smallSlot * 2;
    arrived(0, screen);
    arrived(0, 2 * screen);
    EXPECT_EQ(NotedGl::noted.created, 2);
    EXPECT_EQ(NotedGl::noted.deleted, 1) << "it grew";
    EXPECT_TRUE(holds(arrived(3, poster), 3, poster));
    EXPECT_EQ(readBack_->bytes(), 4 * poster);
    for (std::uint64_t i = 0; i <= ReadBack::longestIdle; ++i) arrived(0, screen);
    EXPECT_EQ(readBack_->bytes(), 4 * screen);
}

/// The device is gone, as after a loss, and its pictures are still being encoded.
TEST_P(GlReadBack, WhatIsLentOutlivesTheDeviceAndGoesOnAnyThread) {
    auto first = arrived(40, 2000), second = arrived(50, 2000);
    arrived(60, 2000);  // free, and goes with the device
    readBack_.reset();
    EXPECT_EQ(NotedGl::noted.deleted, 1) << "and what is lent stays";
    current_.reset();
    noting_.reset();
    const std::weak_ptr<Context> context = context_;
    context_.reset();
    EXPECT_FALSE(context.expired());
    std::thread([&, pixels = std::move(first)]() mutable {
        EXPECT_TRUE(holds(pixels, 40, 2000));
        pixels = {};
        EXPECT_FALSE(context.expired()) << "there is another";
    }).join();
    EXPECT_TRUE(holds(second, 50, 2000));
    std::thread([&, pixels = std::move(second)]() mutable {
        EXPECT_TRUE(holds(pixels, 50, 2000));
        pixels = {};
        EXPECT_TRUE(context.expired());
    }).join();
    // Whoever opens a context next is not disturbed by how the last one went.
    auto opened = open();
    ASSERT_TRUE(opened) << opened.error().message;
    context_ = std::move(*opened);
    auto current = Context::Current::enter(*context_);
    ASSERT_TRUE(current) << current.error().message;
    current_.emplace(std::move(*current));
    readBack_.emplace(context_->functions(), context_);
    EXPECT_TRUE(holds(arrived(8, 100), 8, 100));
}

/// A reader drops what it was lent while the device goes: one of them ends the context, whoever is last.
TEST_P(GlReadBack, TheLastReaderAndTheDeviceMayGoTogether) {
    for (std::uint32_t i = 0; i < 4; ++i) {
        std::thread reader([pixels = arrived(i, 500), i]() mutable {
            EXPECT_TRUE(holds(pixels, i, 500));
            pixels = {};
        });
        readBack_.reset();
        current_.reset();
        context_.reset();
        reader.join();
        SetUp();
    }
}

/// The same with a whole device, which is closed while its frames are being encoded.
TEST_P(GlReadBack, FramesOutliveTheirDevice) {
    TearDown();  // contexts are current one at a time
    std::vector<Frame> frames;
    const test::AnalyticPoint point{{0, 5, 0}, {10, 20, 30}};
    const test::AnalyticCloud cloud({&point, 1}, 1);
    const Viewpoint from = test::lookAt({0, 0, 0}, {0, 1, 0}, 65, 33);
    const test::Scene scene(from, cloud.cut(), test::sprite(Footprint::Square, Profile::Flat, 200));
    {
        auto device = createDevice({.backend = GetParam()});
        ASSERT_TRUE(device) << device.error().message;
        for (int i = 0; i < 3; ++i) frames.push_back(test::mustDraw(**device, scene.drawing));
        auto begun = (*device)->begin(scene.drawing, {});
        ASSERT_TRUE(begun) << begun.error().message;
        auto last = (*begun)->finish();
        ASSERT_TRUE(last) << last.error().message;
        frames.push_back(std::move(*last));
        auto abandoned = (*device)->begin(scene.drawing, {});
        ASSERT_TRUE(abandoned) << abandoned.error().message;
    }
    std::thread([frames = std::move(frames)]() mutable {
        for (Frame& frame : frames) {
            EXPECT_TRUE(frame.rgba.lent() && frame.depth.lent());
            for (std::size_t i = 0; i < frame.depth.size(); ++i) {
                ASSERT_EQ(frame.rgba[4 * i + 1], 20) << i;
                ASSERT_NEAR(frame.depth[i], 5, 0.01) << i;
            }
            frame = {};
        }
    }).join();
}

}  // namespace
}  // namespace scancast::gl
