#include "ranks/mpi/communicator.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <climits>
#include <optional>
#include <thread>

namespace scancast {

namespace {

/// Counts of MPI are ints: what is longer travels in pieces.
constexpr std::size_t longestPiece = std::size_t(1) << 30;
/// So long without a pause: an answer that is on its way comes at once.
constexpr auto patience = std::chrono::microseconds(100);
constexpr auto longestPause = std::chrono::microseconds(1000);
/// After an interruption: whoever else was interrupted is about to say so.
constexpr auto graceOfOthers = std::chrono::milliseconds(400);
/// Of what join() sends.
constexpr int joinTag = 32000;

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

Expected<void> Communicator::wait(MPI_Request& request) const {
    if (request == MPI_REQUEST_NULL) return {};
    auto done = waitAny(std::span(&request, 1), patience);
    return done ? Expected<void>() : Expected<void>(passOn(done));
}

Expected<std::size_t> Communicator::waitAny(std::span<MPI_Request> requests,
                                            std::chrono::microseconds patience) const {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    std::optional<Clock::time_point> givenUp;
    auto pause = std::chrono::microseconds(10);
    for (;;) {
        if (lost_) return fail(ErrorCode::Cancelled, "Interrupted while ranks waited for each other.");
        int isDone = 0, which = 0;
        if (auto ok = judged(
                MPI_Testany(int(requests.size()), requests.data(), &which, &isDone, MPI_STATUS_IGNORE));
            !ok)
            return passOn(ok);
        if (isDone && which == MPI_UNDEFINED)
            return fail(ErrorCode::Internal, "A rank waits for what nobody began.");
        if (isDone) return std::size_t(which);
        const auto now = Clock::now();
        if (interrupted_.stop_requested()) {
            if (!givenUp) givenUp = now + graceOfOthers;
            if (now > *givenUp) lost_ = true;
        }
        if (now - start < patience) {
            ::sched_yield();  // to who may share the core, and is waited for
            continue;
        }
        std::this_thread::sleep_for(pause);
        pause = std::min(pause * 2, longestPause);
    }
}

Expected<void> Communicator::done(int code, MPI_Request& request) const {
    if (auto ok = judged(code); !ok) return ok;
    return wait(request);
}

Expected<void> Communicator::send(std::span<const std::byte> bytes, int to, int tag) const {
    return inPieces(bytes.size(), [&](std::size_t at, int count) {
        MPI_Request request;
        return done(MPI_Isend(bytes.data() + at, count, MPI_BYTE, to, tag, comm_, &request), request);
    });
}

Expected<void> Communicator::receive(std::span<std::byte> bytes, int from, int tag) const {
    return inPieces(bytes.size(), [&](std::size_t at, int count) {
        MPI_Request request;
        return done(MPI_Irecv(bytes.data() + at, count, MPI_BYTE, from, tag, comm_, &request), request);
    });
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
    const auto ranks = std::size_t(size_);
    std::vector<std::uint64_t> sending(ranks), coming(ranks);
    for (std::size_t r = 0; r < ranks; ++r) sending[r] = out[r].size();
    MPI_Request request;
    if (auto ok = done(
            MPI_Ialltoall(sending.data(), 1, MPI_UINT64_T, coming.data(), 1, MPI_UINT64_T, comm_, &request),
            request);
        !ok)
        return passOn(ok);
    std::uint64_t outgoing = 0, incoming = 0;
    std::vector<int> outCounts, outPlaces, inCounts, inPlaces;
    for (std::size_t r = 0; r < ranks; ++r) {
        outPlaces.push_back(int(std::min<std::uint64_t>(outgoing, INT_MAX)));
        inPlaces.push_back(int(std::min<std::uint64_t>(incoming, INT_MAX)));
        outCounts.push_back(int(std::min<std::uint64_t>(sending[r], INT_MAX)));
        inCounts.push_back(int(std::min<std::uint64_t>(coming[r], INT_MAX)));
        outgoing += sending[r];
        incoming += coming[r];
    }
    // One that may not would leave the others waiting.
    std::uint64_t most = std::max(outgoing, incoming);
    if (auto ok = max(std::span(&most, 1)); !ok) return passOn(ok);
    if (most > INT_MAX)
        return fail(ErrorCode::ResourceLimit, "Ranks have more than 2 GiB to say to each other at once.");
    RankBytes flat(outgoing), got(incoming);
    for (std::size_t r = 0; r < ranks; ++r)
        std::copy(out[r].begin(), out[r].end(), flat.begin() + outPlaces[r]);
    if (auto ok = done(MPI_Ialltoallv(flat.data(), outCounts.data(), outPlaces.data(), MPI_BYTE, got.data(),
                                      inCounts.data(), inPlaces.data(), MPI_BYTE, comm_, &request),
                       request);
        !ok)
        return passOn(ok);
    std::vector<RankBytes> in;
    for (std::size_t r = 0; r < ranks; ++r)
        in.emplace_back(got.begin() + inPlaces[r], got.begin() + inPlaces[r] + inCounts[r]);
    return in;
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
