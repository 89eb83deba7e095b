// What devices of several ranks tell each other between passes (renderer/device/cpu/pass_reduction.hpp), by MPI.
// Rank 0 shows; while it lets others in, all ranks draw what it is asked for. Owned by the rank's device; on its thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "ranks/mpi/communicator.hpp"
#include "renderer/device/cpu/pass_reduction.hpp"

namespace scancast {

/// What one rank and the others have told each other.
struct RankTraffic {
    std::uint64_t bytes = 0;     ///< sent
    std::uint64_t received = 0;  ///< of what was drawn
    std::uint64_t exchanges = 0;
};

class RankReduction final : public cpu::PassReduction {
  public:
    /// `drawOthers`: what ranks do while rank 0 pauses, and rank 0 at its end, so that they go on. All of it outlives this. What MPI
    /// does not like ends all ranks (MpiSession::abortAll): none of them could go on.
    RankReduction(const Communicator& ranks, RankTraffic& traffic, std::function<void()> drawOthers);
    ~RankReduction() override;
    RankReduction(const RankReduction&) = delete;
    RankReduction& operator=(const RankReduction&) = delete;

    std::uint32_t devices() const override { return std::uint32_t(ranks_.size()); }
    std::uint32_t number() const override { return std::uint32_t(ranks_.rank()); }
    std::stop_token begin(std::stop_token stop, const Pause* pause) override;
    bool agree(std::span<std::uint64_t> words) override;
    void exchange(std::span<const cpu::SentSpans> sent, std::span<cpu::ReceivedSpans> received,
                  std::size_t bytesOfSpan, const Arrived& arrived) override;
    [[noreturn]] void giveUp(const Error& error) override;

  private:
    using Clock = std::chrono::steady_clock;

    /// Of the picture that is being drawn; those within its pauses have their own.
    struct Drawn {
        std::stop_token wanted;
        std::stop_source agreed;
        const Pause* pause = nullptr;
        Clock::time_point pausedAt;
    };

    void letOthersIn();
    /// Memory for what one rank sends; grows to the most and stays.
    struct Room {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size = 0;
    };

    const Communicator& ranks_;
    RankTraffic& traffic_;
    const std::function<void()> drawOthers_;
    Drawn drawn_;
    std::vector<std::uint64_t> agreed_;
    std::vector<Room> rooms_;  // by rank
    std::vector<MPI_Request> requests_;
    MPI_Datatype line_ = MPI_DATATYPE_NULL;
};

}  // namespace scancast
