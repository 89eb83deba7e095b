// Tiles under way: what is begun before what is waited for, and that nothing is lost where one fails.
#include "renderer/tiled_picture.hpp"

#include <gmock/gmock.h>

namespace scancast {
namespace {

using testing::ElementsAre;

/// Draws nothing but the places of pixels, and hands a tile over when it is asked for, not before. Notes what
/// is begun ("+0") and what is finished ("-0").
class SlowDevice final : public Device {
  public:
    DeviceInfo info() const override { return {}; }
    Expected<Frame> draw(const Drawing&, std::stop_token) override {
        return fail(ErrorCode::Internal, "Tiles are begun.");
    }
    Expected<std::unique_ptr<PendingFrame>> begin(const Drawing& drawing, std::stop_token) override {
        if (begun_ == failing) return fail(ErrorCode::DeviceLost, "The GPU went away.");
        notes.push_back("+" + std::to_string(begun_));
        return std::make_unique<Pending>(*this, drawing.window, begun_++);
    }

    std::vector<std::string> notes;
    int failing = -1;  ///< the tile that cannot be begun
    int lost = -1;     ///< the tile that does not arrive
    bool isReady = false;
    int alive = 0;

  private:
    class Pending final : public PendingFrame {
      public:
        Pending(SlowDevice& device, const Window& window, int tile)
            : device_(device), window_(window), tile_(tile) {
            ++device_.alive;
        }
        ~Pending() override { --device_.alive; }
        bool ready() override { return device_.isReady; }
        Expected<Frame> finish() override {
            device_.notes.push_back("-" + std::to_string(tile_));
            if (tile_ == device_.lost) return fail(ErrorCode::DeviceLost, "The GPU went away.");
            Frame frame{window_.width, window_.height, {}, {}, {}};
            for (int y = 0; y < window_.height; ++y) {
                for (int x = 0; x < window_.width; ++x)
                    for (const int value : {window_.x + x, window_.y + y, tile_, 255})
                        frame.rgba.own().push_back(static_cast<std::uint8_t>(value));
            }
            return frame;
        }

      private:
        SlowDevice& device_;
        const Window window_;
        const int tile_;
    };
    int begun_ = 0;
};

Expected<std::unique_ptr<PendingFrame>> begin(SlowDevice& device, int width, int height) {
    CutView view;
    view.viewpoint.width = width;
    view.viewpoint.height = height;
    Drawing drawing;
    drawing.cuts = {&view, 1};
    drawing.depth = false;
    return beginPicture(device, drawing, {.side = 10, .margin = 3, .exact = false}, {});
}

TEST(TiledPicture, OfAScreenIsBegunWholeAndWaitedForLater) {
    SlowDevice device;
    const auto begun = begin(device, 20, 15);
    ASSERT_TRUE(begun);
    EXPECT_THAT(device.notes, ElementsAre("+0", "+1", "+2", "+3"));
    EXPECT_FALSE((*begun)->ready());
    device.isReady = true;
    EXPECT_TRUE((*begun)->ready());
    const auto frame = (*begun)->finish();
    ASSERT_TRUE(frame);
    EXPECT_EQ(device.alive, 0);
    EXPECT_TRUE(frame->depth.empty());
    for (std::size_t i = 0; i < 20 * 15; ++i) {
        ASSERT_EQ(frame->rgba[4 * i], i % 20);
        ASSERT_EQ(frame->rgba[4 * i + 1], i / 20);
        ASSERT_EQ(frame->rgba[4 * i + 2], i % 20 / 10 + i / 200 * 2) << "margins do not show";
    }
}

TEST(TiledPicture, OfAPosterHasAFewTilesUnderWay) {
    SlowDevice device;
    const auto begun = begin(device, 30, 20);
    ASSERT_TRUE(begun);
    EXPECT_THAT(device.notes, ElementsAre("+0", "+1", "+2", "+3", "-0", "+4", "-1", "+5"));
    EXPECT_EQ(device.alive, 4);
    EXPECT_TRUE((*begun)->finish());
}

/// As the cpu device does: no more than one tile is in memory beside the picture.
TEST(TiledPicture, OfADeviceThatDrawsAtOnceIsPastedAtOnce) {
    SlowDevice device;
    device.isReady = true;
    ASSERT_TRUE(begin(device, 20, 20));
    EXPECT_THAT(device.notes, ElementsAre("+0", "-0", "+1", "-1", "+2", "-2", "+3", "-3"));
}

TEST(TiledPicture, ATileThatFailsIsThePicturesFailure) {
    SlowDevice cannotBegin, losesOne, losesTheLast;
    cannotBegin.failing = 2;
    const auto notBegun = begin(cannotBegin, 20, 20);
    ASSERT_FALSE(notBegun);
    EXPECT_EQ(notBegun.error().code, ErrorCode::DeviceLost);
    EXPECT_EQ(cannotBegin.alive, 0);
    losesOne.lost = 0;
    EXPECT_FALSE(begin(losesOne, 30, 20));
    EXPECT_EQ(losesOne.alive, 0);
    losesTheLast.lost = 3;
    const auto begun = begin(losesTheLast, 20, 20);
    ASSERT_TRUE(begun);
    EXPECT_FALSE((*begun)->finish());
}

}  // namespace
}  // namespace scancast
