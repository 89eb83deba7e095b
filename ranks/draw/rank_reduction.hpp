// What devices of several ranks agree on between passes (renderer/device/cpu/pass_reduction.hpp), by MPI's reductions of integers.
// What is empty does not travel: ranks first tell each other which 16 elements in a row anybody has something in, a bit each, and
// then reduce these alone, packed. Rank 0 shows. Owned by the rank's device; on its thread.
#pragma once

#include <cstdint>
#include <memory>
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
    /// Both outlive it. What MPI does not like ends all ranks (MpiSession::abortAll): none of them could go on.
    RankReduction(const Communicator& ranks, RankTraffic& traffic) : ranks_(ranks), traffic_(traffic) {}

    std::stop_token begin(std::stop_token stop) override;
    bool shows() const override { return ranks_.isFirst(); }
    void least(std::span<cpu::Key> keys, cpu::Receivers to) override;
    void total(cpu::SumPlanes& sums) override;
    void join(std::span<std::uint32_t> words) override;

  private:
    template <class T, class IsEmpty>
    void findOccupied(std::span<const T> elements, const IsEmpty& isEmpty);
    bool agreeOnOccupied();
    template <class T>
    void reduce(std::span<T> packed, MPI_Datatype type, MPI_Op op, cpu::Receivers to);
    /// Of planes of so many elements each, the occupied ones.
    template <class T>
    void reduceOccupied(std::vector<T>& packed, std::span<T> elements, std::size_t plane, MPI_Datatype type,
                        MPI_Op op, cpu::Receivers to);
    void waitFor(MPI_Request& request) const;

    const Communicator& ranks_;
    RankTraffic& traffic_;
    std::stop_token wanted_;
    std::stop_source agreed_;
    /// Whether anybody stops, all bits of what is summed, then a bit for each span of a plane.
    std::vector<std::uint64_t> header_;
    std::vector<cpu::Key> keys_;
    std::vector<std::int32_t> narrow_;
    std::vector<std::int64_t> wide_;
    std::vector<std::uint32_t> words_;
};

}  // namespace scancast
