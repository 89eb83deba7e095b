// Devices of one process that draw a picture together, each a share of the samples on a thread of its own: as ranks do,
// without any.
#pragma once

#include <algorithm>
#include <barrier>
#include <bit>
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

  private:
    struct Brought {
        std::span<std::uint64_t> words;
        std::span<const cpu::SentSpans> sent;
        std::stop_token wanted;
        std::stop_source agreed;
    };

    class Seat final : public cpu::PassReduction {
      public:
        Seat(Meeting& meeting, std::size_t number) : meeting_(meeting), number_(number) {}

        std::uint32_t devices() const override { return static_cast<std::uint32_t>(meeting_.seats_.size()); }
        std::uint32_t number() const override { return static_cast<std::uint32_t>(number_); }
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
            meeting_.seats_[number_].words = words;
            meeting_.barrier_.arrive_and_wait();
            std::vector<std::uint64_t> all(words.begin(), words.end());
            for (const Brought& other : meeting_.seats_) {
                if (other.words.size() != words.size())
                    throw std::logic_error("They agree on different things.");
                for (std::size_t k = 0; k < all.size(); ++k) all[k] |= other.words[k];
            }
            meeting_.barrier_.arrive_and_wait();
            std::ranges::copy(all, words.begin());
            // Between meetings nobody's changes.
            const bool stopped = std::ranges::any_of(
                meeting_.seats_, [](const Brought& b) { return b.wanted.stop_requested(); });
            meeting_.barrier_.arrive_and_wait();
            if (stopped) meeting_.seats_[number_].agreed.request_stop();
            return !stopped;
        }
        void exchange(std::span<const cpu::SentSpans> sent, std::span<cpu::ReceivedSpans> received,
                      std::size_t bytesOfSpan, const Arrived& arrived) override {
            meeting_.seats_[number_].sent = sent;
            meeting_.barrier_.arrive_and_wait();
            std::vector<std::vector<std::byte>> spans(sent.size());
            for (std::size_t d = 0; d < sent.size(); ++d) {
                const cpu::SentSpans& theirs = meeting_.seats_[d].sent[number_];
                std::size_t marked = 0;
                for (const std::uint64_t word : theirs.marks)
                    marked += static_cast<std::size_t>(std::popcount(word));
                if (theirs.marks.size() != received[d].marks.size() ||
                    marked * bytesOfSpan != theirs.spans.size())
                    throw std::logic_error("What is sent is not what is expected.");
                std::ranges::copy(theirs.marks, received[d].marks.begin());
                spans[d].assign(theirs.spans.begin(), theirs.spans.end());
                received[d].spans = spans[d];
            }
            meeting_.barrier_.arrive_and_wait();
            // The last is the first to come.
            for (std::size_t d = sent.size(); d-- > 0;)
                if (!received[d].marks.empty()) arrived(static_cast<std::uint32_t>(d));
        }
        void giveUp(const Error& error) override { throw std::runtime_error(error.message); }

      private:
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
