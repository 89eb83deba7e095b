// What devices of several ranks agree on between passes (renderer/device/cpu/pass_reduction.hpp), by MPI's reductions of integers.
// Rank 0 shows; while it lets others in, all ranks draw what it is asked for. Owned by the rank's device; on its thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "ranks/mpi/communicator.hpp"
#include "renderer/device/cpu/pass_reduction.hpp"

namespace scancast {

/// What one rank has given to reductions.
struct RankTraffic {
    std::uint64_t bytes = 0;
    std::uint64_t reductions = 0;
};

class RankReduction final : public cpu::PassReduction {
  public:
    /// `drawOthers`: what ranks do while rank 0 pauses, and rank 0 at its end, so that they go on. All of it outlives this. What MPI
    /// does not like ends all ranks (MpiSession::abortAll): none of them could go on.
    RankReduction(const Communicator& ranks, RankTraffic& traffic, std::function<void()> drawOthers)
        : ranks_(ranks), traffic_(traffic), drawOthers_(std::move(drawOthers)) {}

    std::uint32_t devices() const override { return std::uint32_t(ranks_.size()); }
    bool shows() const override { return ranks_.isFirst(); }
    std::stop_token begin(std::stop_token stop, const Pause* pause) override;
    bool agree(std::span<std::uint64_t> words) override;
    void least(std::span<cpu::Key> keys, cpu::Receivers to) override;
    void add(std::span<std::int32_t> sums) override;
    void add(std::span<std::int64_t> sums) override;
    void join(std::span<std::uint32_t> words) override;
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
    template <class T>
    void reduce(std::span<T> elements, MPI_Datatype type, MPI_Op op, cpu::Receivers to);
    void waitFor(MPI_Request& request) const;

    const Communicator& ranks_;
    RankTraffic& traffic_;
    const std::function<void()> drawOthers_;
    Drawn drawn_;
    std::vector<std::uint64_t> agreed_;
};

}  // namespace scancast
