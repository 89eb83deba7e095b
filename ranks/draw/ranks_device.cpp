#include "ranks/draw/ranks_device.hpp"

#include <fmt/format.h>

#include <functional>
#include <tuple>
#include <utility>

#include "ranks/mpi/session.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast {
namespace {

/// The others go on with what they were at.
void goOn(const Communicator& ranks) {
    RankBytes nothing;
    if (auto ok = ranks.broadcast(nothing); !ok) MpiSession::abortAll(ok.error().message);
}

class RanksDevice final : public Device {
  public:
    RanksDevice(const Communicator& ranks, std::shared_ptr<const SharedClouds> clouds,
                std::unique_ptr<Device> together, int threads)
        : ranks_(ranks), clouds_(std::move(clouds)), together_(std::move(together)), threads_(threads) {}

    DeviceInfo info() const override {
        DeviceInfo info = together_->info();
        // What it draws is what the cpu device draws.
        info.renderer = fmt::format("{}, ranks: {}", info.renderer, ranks_.size());
        return info;
    }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        // What cannot be drawn at all nobody else is asked for.
        if (auto ok = checkDrawing(drawing); !ok) return passOn(ok);
        const auto cloud = clouds_->placeOf(drawing.mainView().cut.source);
        if (!cloud || ranks_.size() == 1) return drawAlone(drawing, std::move(stop));
        RankBytes message = packDrawing(*cloud, drawing);
        if (auto ok = ranks_.broadcast(message); !ok) return passOn(ok);
        if (auto ready = ranks_.agree({}); !ready) return passOn(ready);
        return together_->draw(drawing, std::move(stop));
    }

  private:
    Expected<Frame> drawAlone(const Drawing& drawing, std::stop_token stop) {
        if (!alone_) {
            auto made = createCpuDevice(threads_);
            if (!made) return passOn(made);
            alone_ = std::move(*made);
        }
        return alone_->draw(drawing, std::move(stop));
    }

    const Communicator& ranks_;
    const std::shared_ptr<const SharedClouds> clouds_;
    const std::unique_ptr<Device> together_;
    const int threads_;
    std::unique_ptr<Device> alone_;  // when it is first needed
};

}  // namespace

Expected<std::unique_ptr<Device>> createRanksDevice(const Communicator& ranks,
                                                    std::shared_ptr<const SharedClouds> clouds, int threads,
                                                    RankTraffic& traffic) {
    auto together =
        createCpuDevice(threads, std::make_unique<RankReduction>(ranks, traffic, [&ranks] { goOn(ranks); }));
    if (!together) return passOn(together);
    return std::make_unique<RanksDevice>(ranks, std::move(clouds), std::move(*together), threads);
}

Expected<void> drawWithFirst(const Communicator& ranks, OpenedClouds clouds, int threads) {
    RankTraffic traffic;
    std::unique_ptr<Device> device;
    std::function<Expected<void>()> drawUntilNothing = [&]() -> Expected<void> {
        for (;;) {
            RankBytes message;
            if (auto ok = ranks.broadcast(message); !ok) return ok;
            if (message.empty()) return {};
            auto drawing = unpackDrawing(message);
            auto provided = drawing ? clouds.provide(**drawing) : Expected<void>(passOn(drawing));
            if (!ranks.agree(provided)) continue;                 // rank 0 says so
            std::ignore = device->draw((*drawing)->drawing, {});  // what all refuse, rank 0 says
        }
    };
    auto made = createCpuDevice(threads, std::make_unique<RankReduction>(ranks, traffic, [&] {
                                    if (auto ok = drawUntilNothing(); !ok)
                                        MpiSession::abortAll(ok.error().message);
                                }));
    if (!made) MpiSession::abortAll(made.error().message);  // rank 0 may be waiting already
    device = std::move(*made);
    return drawUntilNothing();
}

Expected<void> letGo(const Communicator& ranks) {
    RankBytes nothing;
    return ranks.broadcast(nothing);
}

}  // namespace scancast
