// The scheduler on devices of the renderer's, one of which is lost while it draws.
#include <gtest/gtest.h>

#include <cmath>
#include <future>

#include "protocol/depth/frame_depth.hpp"
#include "renderer/render.hpp"
#include "server/scheduler/scheduler.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

/// The cpu device under another name, which is lost at the n-th picture: on being begun, or with its pixels.
class FragileDevice final : public Device {
  public:
    enum class Loss : std::uint8_t { Beginning, Finishing };

    FragileDevice(int pictures, Loss loss) : left_(pictures), loss_(loss) {}

    DeviceInfo info() const override {
        DeviceInfo info = cpu_->info();
        info.name = "fragile";
        info.identity = "fragile";
        info.hardware = true;
        return info;
    }
    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        auto begun = begin(drawing, std::move(stop));
        if (!begun) return passOn(begun);
        return (*begun)->finish();
    }
    Expected<std::unique_ptr<PendingFrame>> begin(const Drawing& drawing, std::stop_token stop) override {
        const bool breaks = --left_ < 0;
        if (breaks && loss_ == Loss::Beginning) return fail(ErrorCode::DeviceLost, "It broke.");
        auto frame = cpu_->draw(drawing, std::move(stop));
        if (!frame) return passOn(frame);
        return std::make_unique<Pixels>(std::move(*frame), breaks);
    }

  private:
    struct Pixels final : PendingFrame {
        Frame frame;
        bool breaks;
        Pixels(Frame drawn, bool broken) : frame(std::move(drawn)), breaks(broken) {}
        bool ready() override { return false; }
        Expected<Frame> finish() override {
            if (breaks) return fail(ErrorCode::DeviceLost, "It broke.");
            return std::move(frame);
        }
    };

    std::unique_ptr<Device> cpu_ = *createDevice({.backend = "cpu", .threads = 2});
    int left_;
    Loss loss_;
};

OpenPainter cpuPainter() {
    return painterWith([] { return createDevice({.backend = "cpu", .threads = 2}); });
}

OpenPainter fragilePainter(int pictures, FragileDevice::Loss loss) {
    return painterWith(
        [pictures, loss]() -> Expected<std::unique_ptr<Device>> {
            return std::make_unique<FragileDevice>(pictures, loss);
        },
        cpuPainter());
}

EncodedPicture snapshot(Scheduler& scheduler, const std::shared_ptr<const Cloud>& cloud, int width) {
    PictureOrder order;
    order.cloud = cloud;
    order.view = defaultView(*cloud, width, 24);
    order.format = PictureFormat::Png;
    std::promise<Expected<EncodedPicture>> result;
    EXPECT_TRUE(scheduler.snapshot(
        order, [&](Expected<EncodedPicture> picture) { result.set_value(std::move(picture)); }));
    auto future = result.get_future();
    if (future.wait_for(test::FakePainter::patience) != std::future_status::ready) {
        ADD_FAILURE() << "no answer";
        std::abort();
    }
    auto picture = future.get();
    EXPECT_TRUE(picture) << picture.error().message;
    return picture ? *picture : EncodedPicture{};
}

/// The cpu device, which says of what it draws whether depth is wanted.
class NotingDevice final : public Device {
  public:
    explicit NotingDevice(std::vector<bool>& depth) : depth_(depth) {}
    DeviceInfo info() const override { return cpu_->info(); }
    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        depth_.push_back(drawing.depth);
        return cpu_->draw(drawing, std::move(stop));
    }

  private:
    std::vector<bool>& depth_;
    std::unique_ptr<Device> cpu_ = *createDevice({.backend = "cpu", .threads = 2});
};

class FragilePainter : public testing::TestWithParam<FragileDevice::Loss> {};
INSTANTIATE_TEST_SUITE_P(Server, FragilePainter,
                         testing::Values(FragileDevice::Loss::Beginning, FragileDevice::Loss::Finishing));

/// Oracle: the same pictures on the cpu device alone.
TEST_P(FragilePainter, PicturesAfterTheLossAreThoseOfTheCpuDevice) {
    const auto cloud = test::tinyCloud();
    Metrics metrics("test"), others("test");
    Scheduler fragile(fragilePainter(2, GetParam()), {}, metrics), sound(cpuPainter(), {}, others);
    for (int i = 0; i < 5; ++i) {
        const EncodedPicture a = snapshot(fragile, cloud, 30 + i), b = snapshot(sound, cloud, 30 + i);
        ASSERT_TRUE(a.bytes && b.bytes);
        EXPECT_EQ(*a.bytes, *b.bytes) << i;
        EXPECT_EQ(a.device.identity, i < 2 ? "fragile" : b.device.identity) << i;
        EXPECT_EQ(a.stats.device, i < 2 ? "fragile" : "cpu") << i;
        EXPECT_EQ(a.stats.samplesDrawn, b.stats.samplesDrawn);
        ASSERT_EQ(a.stats.stages.size(), b.stats.stages.size());
        for (std::size_t s = 0; s < a.stats.stages.size(); ++s)
            EXPECT_EQ(a.stats.stages[s].name, b.stats.stages[s].name);
    }
    EXPECT_EQ(fragile.device().lost->error.message, "It broke.");
}

TEST(DevicePainter, OnlyPicturesOfDepthAskForIt) {
    const auto cloud = test::tinyCloud();
    std::vector<bool> asked;
    const auto painter = painterWith(
        [&]() -> Expected<std::unique_ptr<Device>> { return std::make_unique<NotingDevice>(asked); })();
    ASSERT_TRUE(painter) << painter.error().message;
    for (const PictureFormat format : {PictureFormat::Jpeg, PictureFormat::Png, PictureFormat::Depth}) {
        PictureOrder order;
        order.cloud = cloud;
        order.view = defaultView(*cloud, 40, 24);
        order.format = format;
        const auto prepared = painter->prepare(order, true, {});
        ASSERT_TRUE(prepared) << prepared.error().message;
        const auto begun = painter->begin(order, *prepared, {}, {});
        ASSERT_TRUE(begun) << begun.error().message;
        const auto frame = (*begun)->finish();
        ASSERT_TRUE(frame) << frame.error().message;
        const auto bytes = encodePicture(*frame, order.view, format);
        ASSERT_TRUE(bytes) << bytes.error().message;
        EXPECT_EQ(bytes->size() == 40 * 24 * 4, format == PictureFormat::Depth);
    }
    EXPECT_EQ(asked, (std::vector<bool>{false, false, true}));
}

/// Oracle: the snapshot of depth, which here has as many pixels as there are cells.
TEST(DevicePainter, APictureWithDepthIsTheSamePictureAndItsDepthThatOfTheSnapshot) {
    const auto cloud = test::tinyCloud();
    std::vector<bool> asked;
    const auto painter = painterWith(
        [&]() -> Expected<std::unique_ptr<Device>> { return std::make_unique<NotingDevice>(asked); })();
    ASSERT_TRUE(painter) << painter.error().message;
    const auto drawn = [&](PictureFormat format, bool withDepth) {
        PictureOrder order;
        order.cloud = cloud;
        order.view = defaultView(*cloud, 40, 24);
        order.view.quality.samples = 1;
        order.format = format;
        order.withDepth = withDepth;
        const auto prepared = painter->prepare(order, true, {});
        EXPECT_TRUE(prepared);
        auto begun = painter->begin(order, *prepared, {}, {});
        EXPECT_TRUE(begun);
        auto frame = (*begun)->finish();
        EXPECT_TRUE(frame);
        return std::pair(std::move(*frame), order.view);
    };
    const auto [with, view] = drawn(PictureFormat::Jpeg, true);
    const Frame without = drawn(PictureFormat::Jpeg, false).first;
    const Frame deep = drawn(PictureFormat::Depth, false).first;
    EXPECT_EQ(asked, (std::vector<bool>{true, false, true}));
    EXPECT_EQ(*encodePicture(with, view, PictureFormat::Jpeg),
              *encodePicture(without, view, PictureFormat::Jpeg));
    const auto packed = encodeDepth(with);
    ASSERT_TRUE(packed) << packed.error().message;
    const auto depth = unpackDepth(*packed);
    ASSERT_TRUE(depth) << depth.error().message;
    ASSERT_EQ(depth->inverse.size(), deep.depth.size());
    int covered = 0;
    for (std::size_t i = 0; i < deep.depth.size(); ++i) {
        if (std::isinf(deep.depth[i])) {
            EXPECT_EQ(depth->inverse[i], 0);
            continue;
        }
        ++covered;
        EXPECT_NEAR(double(depth->inverse[i]) * double(deep.depth[i]), 1, 1.0 / 1000);
    }
    EXPECT_GT(covered, 0);
    const auto missing = encodeDepth(without);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::Internal);
}

/// A plan that the order brings is the one that is drawn; one of another quality lends what it knows; and
/// what the painter had to find out comes back for the next turn.
TEST(DevicePainter, PlansAnOrderOnce) {
    const auto cloud = test::tinyCloud();
    const auto painter = cpuPainter()();
    ASSERT_TRUE(painter) << painter.error().message;
    PictureOrder order;
    order.cloud = cloud;
    order.view = defaultView(*cloud, 40, 24);
    order.view.style.method = "auto";
    const auto found = painter->prepare(order, true, {});
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->planned);
    EXPECT_EQ(found->view->planned, found->planned);

    order.planned = found->planned;
    EXPECT_EQ(painter->prepare(order, true, {})->planned, found->planned);
    order.view.quality.samples = 1;
    const auto other = painter->prepare(order, true, {})->planned;
    EXPECT_NE(other, found->planned);
    EXPECT_EQ(other->view, order.view);
    EXPECT_EQ(other->method, found->planned->method);
}

TEST(DevicePainter, WhatCannotBeOpenedIsAnErrorAndNotReplaced) {
    Metrics metrics("test");
    Scheduler scheduler(devicePainter({.backend = "vulkan"}), {}, metrics);
    EXPECT_EQ(scheduler.waitForDevice(test::FakePainter::patience).state, DeviceStatus::State::Failed);
}

}  // namespace
}  // namespace scancast
