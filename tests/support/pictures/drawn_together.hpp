// Devices of one process that draw a picture together, each a share of the samples on a thread of its own: as ranks do,
// without any.
#pragma once

#include <algorithm>
#include <barrier>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
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
    int narrowSums = 0, wideSums = 0;  ///< reductions of 32 and of 64 bits

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

        std::uint32_t devices() const override { return static_cast<std::uint32_t>(meeting_.seats_.size()); }
        bool shows() const override { return number_ == 0; }
        std::stop_token begin(std::stop_token stop, const Pause*) override {
            Brought& own = meeting_.seats_[number_];
            own.wanted = std::move(stop);
            own.agreed = {};
            return own.agreed.get_token();
        }
        bool agree(std::span<std::uint64_t> words) override {
            if (number_ == 0) {
                ++meeting_.meetings;
                meeting_.onMeeting();
            }
            meet(words, cpu::Receivers::Everybody, [](std::uint64_t a, std::uint64_t b) { return a | b; });
            // Between meetings nobody's changes.
            const bool stopped = std::ranges::any_of(
                meeting_.seats_, [](const Brought& b) { return b.wanted.stop_requested(); });
            meeting_.barrier_.arrive_and_wait();
            if (stopped) meeting_.seats_[number_].agreed.request_stop();
            return !stopped;
        }
        void least(std::span<cpu::Key> keys, cpu::Receivers to) override {
            meet(keys, to, [](cpu::Key a, cpu::Key b) { return std::min(a, b); });
        }
        void add(std::span<std::int32_t> sums) override {
            if (number_ == 0) ++meeting_.narrowSums;
            meet(sums, cpu::Receivers::WhoShows, [](std::int32_t a, std::int32_t b) { return a + b; });
        }
        void add(std::span<std::int64_t> sums) override {
            if (number_ == 0) ++meeting_.wideSums;
            meet(sums, cpu::Receivers::WhoShows, [](std::int64_t a, std::int64_t b) { return a + b; });
        }
        void giveUp(const Error& error) override { throw std::runtime_error(error.message); }
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
            meeting_.barrier_.arrive_and_wait();
            std::vector<T> all(own.size(), T(0x5a5a5a5a));  // unless somebody is to look at it
            if (shows() || to == cpu::Receivers::Everybody) {
                all.assign(own.begin(), own.end());
                for (std::size_t i = 0; i < meeting_.seats_.size(); ++i) {
                    const Brought& other = meeting_.seats_[i];
                    if (i == number_ || other.count != own.size()) continue;
                    const T* const from = static_cast<const T*>(other.first);
                    for (std::size_t k = 0; k < all.size(); ++k) all[k] = reduce(all[k], from[k]);
                }
            }
            meeting_.barrier_.arrive_and_wait();
            std::ranges::copy(all, own.begin());
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
