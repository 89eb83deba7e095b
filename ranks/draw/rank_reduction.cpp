#include "ranks/draw/rank_reduction.hpp"

#include <sched.h>

#include <algorithm>

#include "ranks/mpi/session.hpp"

namespace scancast {
namespace {

/// What is agreed on beside the words.
constexpr std::uint64_t stops = 1, pauses = 2;
/// Others are at the same pass, and mostly done with it soon.
constexpr auto patience = std::chrono::milliseconds(20);
/// Between pauses, as the cpu device makes them (renderer/device/cpu/workers.hpp).
constexpr auto slice = std::chrono::milliseconds(6);

}  // namespace

void RankReduction::giveUp(const Error& error) {
    MpiSession::abortAll("Ranks cannot go on drawing together: " + error.message);
}

std::stop_token RankReduction::begin(std::stop_token stop, const Pause* pause) {
    drawn_ = {std::move(stop), {}, pause != nullptr && *pause ? pause : nullptr, Clock::now()};
    return drawn_.agreed.get_token();
}

void RankReduction::waitFor(MPI_Request& request) const {
    const auto end = Clock::now() + patience;
    int isDone = 0;
    while (MPI_Test(&request, &isDone, MPI_STATUS_IGNORE) == MPI_SUCCESS && !isDone && Clock::now() < end)
        ::sched_yield();
    if (isDone) return;
    if (auto ok = ranks_.wait(request); !ok) MpiSession::abortAll(ok.error().message);
}

bool RankReduction::agree(std::span<std::uint64_t> words) {
    agreed_.assign(words.begin(), words.end());
    const bool isDue = drawn_.pause != nullptr && Clock::now() > drawn_.pausedAt + slice;
    agreed_.push_back((drawn_.wanted.stop_requested() ? stops : 0) | (isDue ? pauses : 0));
    if (ranks_.size() > 1) {
        MPI_Request request;
        if (MPI_Iallreduce(MPI_IN_PLACE, agreed_.data(), int(agreed_.size()), MPI_UINT64_T, MPI_BOR,
                           ranks_.handle(), &request) != MPI_SUCCESS)
            MpiSession::abortAll("A reduction did not begin.");
        waitFor(request);
        traffic_.bytes += agreed_.size() * sizeof agreed_[0];
    }
    std::copy_n(agreed_.begin(), words.size(), words.begin());
    const std::uint64_t flags = agreed_.back();
    if (flags & stops)
        drawn_.agreed.request_stop();
    else if (flags & pauses)
        letOthersIn();
    return !(flags & stops);
}

void RankReduction::letOthersIn() {
    Drawn own = std::move(drawn_);
    drawn_ = {};
    if (own.pause != nullptr) (*own.pause)();
    drawOthers_();
    drawn_ = std::move(own);
    drawn_.pausedAt = Clock::now();
}

template <class T>
void RankReduction::reduce(std::span<T> elements, MPI_Datatype type, MPI_Op op, cpu::Receivers to) {
    if (elements.empty() || ranks_.size() == 1) return;
    const int count = int(elements.size());
    int code = MPI_SUCCESS;
    if (to == cpu::Receivers::Everybody)
        code = MPI_Allreduce(MPI_IN_PLACE, elements.data(), count, type, op, ranks_.handle());
    else if (shows())
        code = MPI_Reduce(MPI_IN_PLACE, elements.data(), count, type, op, 0, ranks_.handle());
    else
        code = MPI_Reduce(elements.data(), nullptr, count, type, op, 0, ranks_.handle());
    if (code != MPI_SUCCESS) MpiSession::abortAll("A reduction failed.");
    traffic_.bytes += elements.size_bytes();
    ++traffic_.reductions;
}

void RankReduction::least(std::span<cpu::Key> keys, cpu::Receivers to) {
    reduce(keys, MPI_INT64_T, MPI_MIN, to);
}

void RankReduction::add(std::span<std::int32_t> sums) {
    reduce(sums, MPI_INT32_T, MPI_SUM, cpu::Receivers::WhoShows);
}

void RankReduction::add(std::span<std::int64_t> sums) {
    reduce(sums, MPI_INT64_T, MPI_SUM, cpu::Receivers::WhoShows);
}

void RankReduction::join(std::span<std::uint32_t> words) {
    reduce(words, MPI_UINT32_T, MPI_BOR, cpu::Receivers::WhoShows);
}

}  // namespace scancast
