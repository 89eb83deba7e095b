// Devices of one process that draw a picture together, each a share of the samples on a thread of its own: as ranks do,
// without any.
#pragma once

#include <algorithm>
#include <barrier>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/node_share.hpp"

namespace scancast::test {

/// Where devices agree, all in one memory. The first one shows.
class Meeting {
  public:
    explicit Meeting(std::size_t devices) : seats_(devices), barrier_(static_cast<std::ptrdiff_t>(devices)) {}

    std::unique_ptr<cpu::PassReduction> seat(std::size_t number) {
        return std::make_unique<Seat>(*this, number);
    }
    /// Called by the first device each time that all of them meet.
    std::function<void()> onMeeting = [] {};
    int meetings = 0;
    bool wide = false;  ///< sums are in 64 bits though they need not be

  private:
    struct Brought {
        void* first = nullptr;
        std::size_t count = 0;
        std::stop_token wanted;
        std::stop_source agreed;
    };

    class Seat final : public cpu::PassReduction {
      public:
        Seat(Meeting& meeting, std::size_t number) : meeting_(meeting), number_(number) {}

        std::stop_token begin(std::stop_token stop) override {
            Brought& own = meeting_.seats_[number_];
            own.wanted = std::move(stop);
            own.agreed = {};
            return own.agreed.get_token();
        }
        bool shows() const override { return number_ == 0; }
        void least(std::span<cpu::Key> keys, cpu::Receivers to) override {
            meet(keys, to, [](cpu::Key a, cpu::Key b) { return std::min(a, b); });
        }
        void total(cpu::SumPlanes& sums) override {
            std::vector<std::int64_t> all(sums.count * sums.pixels);
            for (std::size_t i = 0; i < all.size(); ++i) all[i] = sums.at(i);
            meet(std::span(all), cpu::Receivers::WhoShows,
                 [](std::int64_t a, std::int64_t b) { return a + b; });
            if (!shows()) return;
            const auto fits = [](std::int64_t sum) { return sum >> 31 == 0 || sum >> 31 == -1; };
            sums.isWide = meeting_.wide || !std::ranges::all_of(all, fits);
            sums.grow();
            for (std::size_t i = 0; i < all.size(); ++i) {
                if (sums.isWide)
                    sums.wide[i] = all[i];
                else
                    sums.narrow[i] = static_cast<std::int32_t>(all[i]);
            }
        }
        void join(std::span<std::uint32_t> words) override {
            meet(words, cpu::Receivers::WhoShows, [](std::uint32_t a, std::uint32_t b) {
                return a == 0 || b == 0 ? a | b : 0xdeadbeef;  // two owners: a picture that is wrong
            });
        }

      private:
        template <class T, class Reduce>
        void meet(std::span<T> own, cpu::Receivers to, const Reduce& reduce) {
            Brought& seat = meeting_.seats_[number_];
            seat.first = own.data();
            seat.count = own.size();
            if (number_ == 0) {
                ++meeting_.meetings;
                meeting_.onMeeting();
            }
            meeting_.barrier_.arrive_and_wait();
            const bool stopped = std::ranges::any_of(
                meeting_.seats_, [](const Brought& b) { return b.wanted.stop_requested(); });
            std::vector<T> all;
            if (shows() || to == cpu::Receivers::Everybody) {
                all.assign(own.begin(), own.end());
                for (std::size_t i = 0; i < meeting_.seats_.size(); ++i) {
                    const Brought& other = meeting_.seats_[i];
                    if (i == number_ || other.count != own.size()) continue;
                    const T* const from = static_cast<const T*>(other.first);
                    for (std::size_t k = 0; k < all.size(); ++k) all[k] = reduce(all[k], from[k]);
                }
            } else {
                all.assign(own.size(), T(0x5a5a5a5a));  // nobody is to look at it
            }
            meeting_.barrier_.arrive_and_wait();
            std::ranges::copy(all, own.begin());
            if (stopped) seat.agreed.request_stop();
            meeting_.barrier_.arrive_and_wait();
        }

        Meeting& meeting_;
        const std::size_t number_;
    };

    std::vector<Brought> seats_;
    std::barrier<> barrier_;
};

/// Of a prepared picture, what is one's share.
inline PreparedView shareOf(const PreparedView& whole, NodeShare share) {
    PreparedView own = whole;
    const auto leaveOthers = [&](CutView& view) {
        for (CutRun& run : view.cut.runs) {
            if (share.has(run.nodeIndex)) continue;
            run.samples = {};
            run.limits = {};
            run.beside = {};
        }
    };
    for (CutView& view : own.cuts) leaveOthers(view);
    if (own.sun) leaveOthers(*own.sun);
    return own;
}

/// The first device's picture; what the others say must be alike. `stops`: of each device.
inline Expected<Frame> drawTogether(Meeting& meeting, std::uint32_t devices, const PreparedView& whole,
                                    int threads, std::vector<std::stop_token> stops = {}) {
    std::vector<std::optional<Expected<Frame>>> frames(devices);
    stops.resize(devices);
    {
        std::vector<std::jthread> running;
        for (std::uint32_t i = 0; i < devices; ++i) {
            running.emplace_back([&, i] {
                auto device = createCpuDevice(threads, meeting.seat(i));
                frames[i] = draw(**device, shareOf(whole, {i, devices}), stops[i]);
            });
        }
    }
    for (std::uint32_t i = 1; i < devices; ++i) {
        if (frames[i]->has_value() != frames[0]->has_value())
            return fail(ErrorCode::Internal, "One of the devices says something else.");
        if (frames[i]->has_value() && !(**frames[i]).rgba.empty())
            return fail(ErrorCode::Internal, "A device that does not show has pixels.");
    }
    return std::move(*frames[0]);
}

}  // namespace scancast::test
