// Ranks that talk to each other: MPI with errors as Expected, lengths of 64 bits, and waiting that leaves the processor to who works.
// Owned by a session or whoever split it off; several threads may use one, but two may not be in the same kind of call at once.
// Place: everything in ranks/ → **communicator** → MPI.
//
// Whatever is named "all ranks call it" hangs until all do: what may fail between two such calls goes through agree() first.
#pragma once

#include <mpi.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "ranks/mpi/rank_bytes.hpp"

namespace scancast {

class Communicator {
  public:
    /// A duplicate of `of`, so that its messages are nobody else's. All ranks call it.
    Communicator(MPI_Comm of, std::stop_token interrupted);
    ~Communicator();
    Communicator(const Communicator&) = delete;
    Communicator& operator=(const Communicator&) = delete;

    int rank() const { return rank_; }
    int size() const { return size_; }
    bool isFirst() const { return rank_ == 0; }
    MPI_Comm handle() const { return comm_; }

    /// Others may be at work for minutes, or they are there and bytes are on their way.
    enum class Pace { Patient, Brisk };

    /// Waits for what a call of MPI's began: at first without a pause, then with longer and longer ones, a millisecond at most.
    /// Errors: MPI's own, as Io; Cancelled some moments after an interruption, and from then on always: MPI may still hold the memory
    /// that was given to it, so the process is to end.
    Expected<void> wait(MPI_Request& request) const { return wait(std::span(&request, 1), Pace::Patient); }
    /// The same for one of some, of which at least one is under way: which it is. `patience`: so long without a pause.
    Expected<std::size_t> waitAny(std::span<MPI_Request> requests, std::chrono::microseconds patience) const;
    /// Somebody gave up waiting.
    bool isLost() const { return lost_; }

    /// Of any length; `tag` below 32768. The other has to know the length.
    Expected<void> send(std::span<const std::byte> bytes, int to, int tag, Pace pace = Pace::Patient) const;
    Expected<void> receive(std::span<std::byte> bytes, int from, int tag) const;
    Expected<void> sendNothing(int to, int tag) const;
    /// One message that send() sent in one piece, of 1 GiB at most, into the begin of `room`: its length. The sender is there.
    /// Where that comes to nothing, sendNothing() says so.
    Expected<std::size_t> receiveSome(std::span<std::byte> room, int from, int tag) const;

    // All ranks call these.
    Expected<void> broadcast(std::span<std::byte> bytes, int from = 0) const;
    /// With their length.
    Expected<void> broadcast(RankBytes& bytes, int from = 0) const;
    /// Of everybody's numbers, one by one; all ranks have the result.
    Expected<void> sum(std::span<std::uint64_t> numbers) const { return reduce(numbers, MPI_SUM); }
    Expected<void> max(std::span<std::uint64_t> numbers) const { return reduce(numbers, MPI_MAX); }
    Expected<void> min(std::span<std::uint64_t> numbers) const { return reduce(numbers, MPI_MIN); }
    /// At rank 0, everybody's bytes in the order of the ranks; elsewhere nothing.
    Expected<std::vector<RankBytes>> gather(const RankBytes& mine) const;
    /// `out`: what goes to each rank; `in` becomes what came from each, in their order, in the memory that it has as far as that reaches.
    /// What is under way at once is in nobody's memory limit: who has much to say does it in rounds.
    Expected<void> exchange(std::span<const std::span<const std::byte>> out,
                            std::vector<RankBytes>& in) const;
    Expected<std::vector<RankBytes>> exchange(const std::vector<RankBytes>& out) const;
    /// `join` is called with others' bytes, along a tree of ranks, in the same order each time; `mine` is asked for after all of
    /// these. At rank 0 everything has been joined then.
    Expected<void> join(const std::function<RankBytes()>& mine,
                        const std::function<Expected<void>(std::span<const std::byte>)>& join) const;

    /// All is well everywhere, or the error of the lowest rank that has one - of those that are not just stopped - is everybody's.
    Expected<void> agree(const Expected<void>& mine) const;
    template <class T>
    Expected<T> agree(Expected<T> mine) const {
        if (auto all = agree(mine ? Expected<void>() : Expected<void>(tl::unexpected(mine.error()))); !all)
            return passOn(all);
        return mine;
    }

  private:
    Expected<void> wait(std::span<MPI_Request> requests, Pace pace, MPI_Status* statuses = nullptr) const;
    /// `isDone` is asked until it says so, without a pause at first, giving way to who may share the core and is waited for.
    Expected<void> waitUntil(const std::function<Expected<bool>()>& isDone,
                             std::chrono::microseconds patience,
                             std::chrono::microseconds longestPause) const;
    Expected<void> reduce(std::span<std::uint64_t> numbers, MPI_Op op) const;
    Expected<void> done(int code, MPI_Request& request) const;

    MPI_Comm comm_ = MPI_COMM_NULL;
    int rank_ = 0, size_ = 1;
    std::stop_token interrupted_;
    mutable std::atomic<bool> lost_{false};
};

}  // namespace scancast
