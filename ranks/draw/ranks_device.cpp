#include "ranks/draw/ranks_device.hpp"

#include <fmt/format.h>

#include <exception>
#include <functional>
#include <string_view>
#include <thread>
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

/// The others are at a picture that this rank cannot go on with.
[[noreturn]] void giveUpAll(const Communicator& ranks, std::string_view why) {
    MpiSession::abortAll(
        fmt::format("Ranks cannot go on drawing together: rank {} failed: {}", ranks.rank(), why));
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
        if (!cloud) return passOn(cloud);
        if (!*cloud || ranks_.size() == 1) return drawAlone(drawing, std::move(stop));
        RankBytes message = packDrawing(**cloud, drawing);
        try {
            if (auto ok = ranks_.broadcast(message); !ok) giveUpAll(ranks_, ok.error().message);
            if (auto ready = ranks_.agree(Expected<void>()); !ready) return passOn(ready);
            return together_->draw(drawing, std::move(stop));
        } catch (const std::exception& e) {
            giveUpAll(ranks_, e.what());
        }
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

Expected<void> canDraw(int threads) {
    auto made = createCpuDevice(threads);
    return made ? Expected<void>() : Expected<void>(passOn(made));
}

Expected<void> drawWithFirst(const Communicator& ranks, OpenedClouds& clouds, int threads) {
    std::jthread opener([&clouds] { clouds.openWithFirst(); });
    RankTraffic traffic;
    std::unique_ptr<Device> device;
    std::function<Expected<void>()> drawUntilNothing = [&]() -> Expected<void> {
        for (;;) try {
                RankBytes message;
                if (auto ok = ranks.broadcast(message); !ok) return ok;
                if (message.empty()) return {};
                // What is thrown before all have agreed is an answer; afterwards the others wait for this rank.
                const auto drawing = ranks.agree(clouds.unpack(message));
                if (!drawing) continue;                               // rank 0 says so
                std::ignore = device->draw((*drawing)->drawing, {});  // what all refuse, rank 0 says
            } catch (const std::exception& e) {
                giveUpAll(ranks, e.what());
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

Expected<void> letGo(const Communicator& ranks, const Communicator& opening) {
    RankBytes nothing;
    if (auto ok = opening.broadcast(nothing); !ok) return ok;
    return ranks.broadcast(nothing);
}

}  // namespace scancast
