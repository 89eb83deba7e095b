#include "ranks/draw/rank_reduction.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "ranks/mpi/session.hpp"

namespace scancast {
namespace {

/// What is agreed on beside the words.
constexpr std::uint64_t stops = 1, pauses = 2;
/// Others are at the same pass, and mostly done with it soon.
constexpr auto patience = std::chrono::milliseconds(20);
using Line = std::array<std::byte, 64>;
constexpr int marksTag = 1, spansTag = 2;

std::size_t waitAnyOf(const Communicator& ranks, std::span<MPI_Request> requests) {
    const auto done = ranks.waitAny(requests, patience);
    if (!done) MpiSession::abortAll(done.error().message);
    return *done;
}

/// Between pauses, as the cpu device makes them (renderer/device/cpu/workers.hpp).
constexpr auto slice = std::chrono::milliseconds(6);

}  // namespace

RankReduction::RankReduction(const Communicator& ranks, RankTraffic& traffic,
                             std::function<void()> drawOthers)
    : ranks_(ranks), traffic_(traffic), drawOthers_(std::move(drawOthers)) {
    if (MPI_Type_contiguous(int(sizeof(Line)), MPI_BYTE, &line_) != MPI_SUCCESS ||
        MPI_Type_commit(&line_) != MPI_SUCCESS)
        MpiSession::abortAll("MPI has no room for a type of data.");
}

RankReduction::~RankReduction() {
    MPI_Type_free(&line_);
}

void RankReduction::giveUp(const Error& error) {
    MpiSession::abortAll("Ranks cannot go on drawing together: " + error.message);
}

std::stop_token RankReduction::begin(std::stop_token stop, const Pause* pause) {
    drawn_ = {std::move(stop), {}, pause != nullptr && *pause ? pause : nullptr, Clock::now()};
    return drawn_.agreed.get_token();
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
        waitAnyOf(ranks_, std::span(&request, 1));
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

void RankReduction::exchange(std::span<const cpu::SentSpans> sent, std::span<cpu::ReceivedSpans> received,
                             std::size_t bytesOfSpan, const Arrived& arrived) {
    const std::size_t ranks = std::size_t(ranks_.size());
    rooms_.resize(ranks);
    // By rank: marks that come, spans that come, marks that go, spans that go.
    requests_.assign(4 * ranks, MPI_REQUEST_NULL);
    std::size_t left = 0;
    const auto begun = [&](int code) {
        if (code != MPI_SUCCESS) MpiSession::abortAll("Ranks cannot exchange what they have drawn.");
        ++left;
    };
    // A span's bytes are whole lines of 64, so that no count is too large for MPI.
    const auto linesOf = [](std::size_t bytes) { return int(bytes / sizeof(Line)); };
    for (std::size_t r = 0; r < ranks; ++r)
        if (!received[r].marks.empty())
            begun(MPI_Irecv(received[r].marks.data(), int(received[r].marks.size()), MPI_UINT64_T, int(r),
                            marksTag, ranks_.handle(), &requests_[r]));
    for (std::size_t r = 0; r < ranks; ++r) {
        if (sent[r].marks.empty()) continue;
        begun(MPI_Isend(sent[r].marks.data(), int(sent[r].marks.size()), MPI_UINT64_T, int(r), marksTag,
                        ranks_.handle(), &requests_[2 * ranks + r]));
        traffic_.bytes += sent[r].marks.size_bytes() + sent[r].spans.size();
        if (sent[r].spans.empty()) continue;
        begun(MPI_Isend(sent[r].spans.data(), linesOf(sent[r].spans.size()), line_, int(r), spansTag,
                        ranks_.handle(), &requests_[3 * ranks + r]));
    }
    if (left > 0) ++traffic_.exchanges;
    for (; left > 0; --left) {
        const std::size_t done = waitAnyOf(ranks_, requests_), r = done % ranks;
        if (done >= 2 * ranks) continue;
        if (done < ranks) {
            std::size_t bytes = 0;
            for (const std::uint64_t word : received[r].marks)
                bytes += std::size_t(std::popcount(word)) * bytesOfSpan;
            Room& room = rooms_[r];
            if (room.size < bytes) {
                room.bytes.reset();
                room.bytes = std::make_unique_for_overwrite<std::byte[]>(bytes);
                room.size = bytes;
            }
            received[r].spans = {room.bytes.get(), bytes};
            traffic_.received += received[r].marks.size_bytes() + bytes;
            if (bytes > 0) {
                begun(MPI_Irecv(room.bytes.get(), linesOf(bytes), line_, int(r), spansTag, ranks_.handle(),
                                &requests_[ranks + r]));
                continue;
            }
        }
        arrived(std::uint32_t(r));
    }
}

}  // namespace scancast
