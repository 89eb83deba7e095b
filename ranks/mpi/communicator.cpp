#include "ranks/mpi/communicator.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <thread>

namespace scancast {

namespace {

/// Counts of MPI are ints: what is longer travels in pieces.
constexpr std::size_t longestPiece = std::size_t(1) << 30;
/// So long without a pause: an answer that is on its way, or the next picture of somebody who moves, comes at once.
constexpr auto patience = std::chrono::microseconds(2000);
constexpr auto longestPause = std::chrono::microseconds(1000);
/// Bytes on their way come on only while MPI is asked: so long by asking again and again, giving way to who works, then with pauses.
constexpr auto briskly = std::chrono::milliseconds(5);
constexpr auto briskPause = std::chrono::microseconds(20);
/// After an interruption: whoever else was interrupted is about to say so.
constexpr auto graceOfOthers = std::chrono::milliseconds(400);
/// Of what join() sends, and exchange().
constexpr int joinTag = 32000, exchangeTag = 32001;

Expected<void> judged(int code) {
    if (code == MPI_SUCCESS) return {};
    std::array<char, MPI_MAX_ERROR_STRING> text{};
    int length = 0;
    MPI_Error_string(code, text.data(), &length);
    return fail(ErrorCode::Io, fmt::format("The ranks cannot reach each other: {}",
                                           std::string_view(text.data(), std::size_t(length))));
}

template <class Each>
Expected<void> inPieces(std::size_t bytes, Each each) {
    for (std::size_t at = 0; at < bytes; at += longestPiece)
        if (auto ok = each(at, int(std::min(longestPiece, bytes - at))); !ok) return ok;
    return {};
}

}  // namespace

Communicator::Communicator(MPI_Comm of, std::stop_token interrupted) : interrupted_(std::move(interrupted)) {
    MPI_Comm_dup(of, &comm_);
    MPI_Comm_set_errhandler(comm_, MPI_ERRORS_RETURN);
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
}

Communicator::~Communicator() {
    if (!lost_) MPI_Comm_free(&comm_);
}

Expected<void> Communicator::waitUntil(const std::function<Expected<bool>()>& isDone,
                                       std::chrono::microseconds patience,
                                       std::chrono::microseconds longestPause) const {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    std::optional<Clock::time_point> givenUp;
    auto pause = std::chrono::microseconds(10);
    for (;;) {
        if (lost_) return fail(ErrorCode::Cancelled, "Interrupted while ranks waited for each other.");
        const auto done = isDone();
        if (!done) return passOn(done);
        if (*done) return {};
        const auto now = Clock::now();
        if (interrupted_.stop_requested()) {
            if (!givenUp) givenUp = now + graceOfOthers;
            if (now > *givenUp) lost_ = true;
        }
        if (now - start < patience) {
            ::sched_yield();
            continue;
        }
        std::this_thread::sleep_for(pause);
        pause = std::min(pause * 2, longestPause);
    }
}

Expected<void> Communicator::wait(std::span<MPI_Request> requests, Pace pace, MPI_Status* statuses) const {
    const auto isDone = [&]() -> Expected<bool> {
        int done = 0;
        if (auto ok = judged(MPI_Testall(int(requests.size()), requests.data(), &done,
                                         statuses ? statuses : MPI_STATUSES_IGNORE));
            !ok)
            return passOn(ok);
        return done != 0;
    };
    return pace == Pace::Brisk ? waitUntil(isDone, briskly, briskPause)
                               : waitUntil(isDone, patience, longestPause);
}

Expected<std::size_t> Communicator::waitAny(std::span<MPI_Request> requests,
                                            std::chrono::microseconds patience) const {
    int which = MPI_UNDEFINED;
    const auto isDone = [&]() -> Expected<bool> {
        int done = 0;
        if (auto ok =
                judged(MPI_Testany(int(requests.size()), requests.data(), &which, &done, MPI_STATUS_IGNORE));
            !ok)
            return passOn(ok);
        return done != 0;
    };
    if (auto ok = waitUntil(isDone, patience, longestPause); !ok) return passOn(ok);
    if (which == MPI_UNDEFINED) return fail(ErrorCode::Internal, "A rank waits for what nobody began.");
    return std::size_t(which);
}

Expected<void> Communicator::done(int code, MPI_Request& request) const {
    if (auto ok = judged(code); !ok) return ok;
    return wait(request);
}

Expected<void> Communicator::send(std::span<const std::byte> bytes, int to, int tag, Pace pace) const {
    return inPieces(bytes.size(), [&](std::size_t at, int count) {
        MPI_Request request;
        if (auto ok = judged(MPI_Isend(bytes.data() + at, count, MPI_BYTE, to, tag, comm_, &request)); !ok)
            return ok;
        return wait(std::span(&request, 1), pace);
    });
}

Expected<void> Communicator::receive(std::span<std::byte> bytes, int from, int tag) const {
    return inPieces(bytes.size(), [&](std::size_t at, int count) {
        MPI_Request request;
        return done(MPI_Irecv(bytes.data() + at, count, MPI_BYTE, from, tag, comm_, &request), request);
    });
}

Expected<void> Communicator::sendNothing(int to, int tag) const {
    MPI_Request request;
    return done(MPI_Isend(nullptr, 0, MPI_BYTE, to, tag, comm_, &request), request);
}

Expected<std::size_t> Communicator::receiveSome(std::span<std::byte> room, int from, int tag) const {
    MPI_Request request;
    if (auto ok = judged(MPI_Irecv(room.data(), int(std::min(longestPiece, room.size())), MPI_BYTE, from, tag,
                                   comm_, &request));
        !ok)
        return passOn(ok);
    MPI_Status status;
    if (auto ok = wait(std::span(&request, 1), Pace::Brisk, &status); !ok) return passOn(ok);
    int count = 0;
    if (auto ok = judged(MPI_Get_count(&status, MPI_BYTE, &count)); !ok) return passOn(ok);
    return std::size_t(count);
}

Expected<void> Communicator::broadcast(std::span<std::byte> bytes, int from) const {
    return inPieces(bytes.size(), [&](std::size_t at, int count) {
        MPI_Request request;
        return done(MPI_Ibcast(bytes.data() + at, count, MPI_BYTE, from, comm_, &request), request);
    });
}

Expected<void> Communicator::broadcast(RankBytes& bytes, int from) const {
    std::uint64_t size = bytes.size();
    if (auto ok = broadcast(std::as_writable_bytes(std::span(&size, 1)), from); !ok) return ok;
    bytes.resize(size);
    return broadcast(std::span(bytes), from);
}

Expected<void> Communicator::reduce(std::span<std::uint64_t> numbers, MPI_Op op) const {
    MPI_Request request;
    return done(
        MPI_Iallreduce(MPI_IN_PLACE, numbers.data(), int(numbers.size()), MPI_UINT64_T, op, comm_, &request),
        request);
}

Expected<std::vector<RankBytes>> Communicator::gather(const RankBytes& mine) const {
    std::vector<std::uint64_t> sizes(std::size_t(size_), 0);
    sizes[std::size_t(rank_)] = mine.size();
    if (auto ok = sum(sizes); !ok) return passOn(ok);
    std::vector<RankBytes> all;
    if (!isFirst()) {
        if (auto ok = send(mine, 0, joinTag); !ok) return passOn(ok);
        return all;
    }
    all.push_back(mine);
    for (int r = 1; r < size_; ++r) {
        if (auto ok = receive(all.emplace_back(sizes[std::size_t(r)]), r, joinTag); !ok) return passOn(ok);
    }
    return all;
}

Expected<std::vector<RankBytes>> Communicator::exchange(const std::vector<RankBytes>& out) const {
    std::vector<RankBytes> in;
    const std::vector<std::span<const std::byte>> spans(out.begin(), out.end());
    if (auto ok = exchange(spans, in); !ok) return passOn(ok);
    return in;
}

Expected<void> Communicator::exchange(std::span<const std::span<const std::byte>> out,
                                      std::vector<RankBytes>& in) const {
    const auto ranks = std::size_t(size_);
    std::vector<std::uint64_t> sending(ranks), coming(ranks);
    for (std::size_t r = 0; r < ranks; ++r) sending[r] = out[r].size();
    MPI_Request request;
    if (auto ok = done(
            MPI_Ialltoall(sending.data(), 1, MPI_UINT64_T, coming.data(), 1, MPI_UINT64_T, comm_, &request),
            request);
        !ok)
        return ok;
    // From where it is to where it is wanted: MPI_Alltoallv would have everything in one array, copied on both sides.
    in.resize(ranks);
    std::vector<MPI_Request> requests;
    for (std::size_t r = 0; r < ranks; ++r) {
        if (int(r) == rank_) {
            in[r].assign(out[r].begin(), out[r].end());
            continue;
        }
        in[r].resize(coming[r]);
        auto begun = inPieces(coming[r], [&](std::size_t at, int count) {
            return judged(MPI_Irecv(in[r].data() + at, count, MPI_BYTE, int(r), exchangeTag, comm_,
                                    &requests.emplace_back()));
        });
        if (!begun) return begun;
    }
    for (std::size_t step = 1; step < ranks; ++step) {
        const std::size_t r = (std::size_t(rank_) + step) % ranks;  // not all to one at first
        auto begun = inPieces(out[r].size(), [&](std::size_t at, int count) {
            return judged(MPI_Isend(out[r].data() + at, count, MPI_BYTE, int(r), exchangeTag, comm_,
                                    &requests.emplace_back()));
        });
        if (!begun) return begun;
    }
    return wait(requests, Pace::Brisk);
}

Expected<void> Communicator::join(
    const std::function<RankBytes()>& mine,
    const std::function<Expected<void>(std::span<const std::byte>)>& join) const {
    Expected<void> result;
    for (int step = 1; step < size_; step *= 2) {
        if (rank_ % (2 * step) != 0) {
            const RankBytes bytes = mine();
            std::uint64_t size = bytes.size();
            if (auto ok = send(std::as_bytes(std::span(&size, 1)), rank_ - step, joinTag); !ok) return ok;
            if (auto ok = send(bytes, rank_ - step, joinTag); !ok) return ok;
            break;
        }
        if (rank_ + step >= size_) continue;
        std::uint64_t size = 0;
        if (auto ok = receive(std::as_writable_bytes(std::span(&size, 1)), rank_ + step, joinTag); !ok)
            return ok;
        RankBytes theirs(size);
        if (auto ok = receive(theirs, rank_ + step, joinTag); !ok) return ok;
        if (result) result = join(theirs);
    }
    return agree(result);
}

Expected<void> Communicator::agree(const Expected<void>& mine) const {
    const auto ranks = std::uint64_t(size_);
    const bool isStopped = !mine && mine.error().code == ErrorCode::Cancelled;
    std::uint64_t first = mine ? 2 * ranks : std::uint64_t(rank_) + (isStopped ? ranks : 0);
    if (auto ok = min(std::span(&first, 1)); !ok) return ok;
    if (first == 2 * ranks) return {};
    const int teller = int(first % ranks);
    RankBytes said;
    if (teller == rank_) {
        said.push_back(std::byte(mine.error().code));
        for (const char c : mine.error().message) said.push_back(std::byte(c));
    }
    if (auto ok = broadcast(said, teller); !ok) return ok;
    if (said.empty()) return fail(ErrorCode::Internal, "A rank failed and does not say why.");
    return fail(ErrorCode(std::to_integer<std::uint8_t>(said[0])),
                std::string(reinterpret_cast<const char*>(said.data() + 1), said.size() - 1));
}

}  // namespace scancast
