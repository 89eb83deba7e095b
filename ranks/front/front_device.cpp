#include "ranks/front/front_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "ranks/draw/packed_drawing.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast {
namespace {

/// Prepared for ranks, no run has samples (FrontStore); prepared for the front, each has all of its node's.
bool hasSamplesElsewhere(const CutView& view) {
    return std::ranges::any_of(view.cut.runs, [](const CutRun& run) {
        return run.samples.empty() && run.node != nullptr && run.node->sampleCount > 0;
    });
}

bool isForRanks(const Drawing& drawing) {
    return std::ranges::any_of(drawing.cuts, hasSamplesElsewhere) ||
           (drawing.sun != nullptr && hasSamplesElsewhere(*drawing.sun));
}

class FrontDevice final : public Device {
  public:
    FrontDevice(JobKeeper& keeper, std::shared_ptr<const FrontClouds> clouds, std::unique_ptr<Device> own)
        : keeper_(keeper), clouds_(std::move(clouds)), own_(std::move(own)) {}

    DeviceInfo info() const override {
        DeviceInfo info = own_->info();
        // What they draw is what the cpu device draws.
        info.renderer += ", before ranks";
        return info;
    }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        if (!isForRanks(drawing)) return own_->draw(drawing, std::move(stop));
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        // What cannot be drawn at all nobody is asked for.
        if (auto ok = checkDrawing(drawing); !ok) return passOn(ok);
        const auto place = clouds_->placeOf(drawing.mainView().cut.source);
        if (!place)
            return fail(ErrorCode::Internal, "A cloud is to be drawn by ranks of which they do not know.");
        return keeper_.draw(packDrawing(*place, drawing), drawing, stop);
    }

  private:
    JobKeeper& keeper_;
    const std::shared_ptr<const FrontClouds> clouds_;
    const std::unique_ptr<Device> own_;
};

}  // namespace

Expected<std::unique_ptr<Device>> createFrontDevice(JobKeeper& keeper,
                                                    std::shared_ptr<const FrontClouds> clouds, int threads) {
    auto own = createCpuDevice(threads);
    if (!own) return passOn(own);
    return std::make_unique<FrontDevice>(keeper, std::move(clouds), std::move(*own));
}

}  // namespace scancast
