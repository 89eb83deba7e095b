#include "ranks/draw/rank_reduction.hpp"

#include <sched.h>

#include <algorithm>
#include <bit>
#include <chrono>

#include "ranks/mpi/session.hpp"

namespace scancast {
namespace {

constexpr std::size_t span = 16;  ///< elements of a bit
/// Of magnitudes that do not fit, whatever they are.
constexpr std::uint64_t wideBits = std::uint64_t{1} << 40;
constexpr std::size_t stops = 0, magnitudes = 1, firstBits = 2;
/// Others are at the same pass, and mostly done with it soon.
constexpr auto patience = std::chrono::milliseconds(20);

[[noreturn]] void giveUp(const Error& error) {
    MpiSession::abortAll("Ranks that draw together have lost each other: " + error.message);
}

/// work(first, count): each span that has its bit.
template <class Work>
void inOccupied(const std::vector<std::uint64_t>& header, std::size_t elements, const Work& work) {
    for (std::size_t word = firstBits; word < header.size(); ++word) {
        for (std::uint64_t bits = header[word]; bits != 0; bits &= bits - 1) {
            const std::size_t first = ((word - firstBits) * 64 + std::size_t(std::countr_zero(bits))) * span;
            work(first, std::min(span, elements - first));
        }
    }
}

}  // namespace

std::stop_token RankReduction::begin(std::stop_token stop) {
    wanted_ = std::move(stop);
    agreed_ = {};
    return agreed_.get_token();
}

void RankReduction::waitFor(MPI_Request& request) const {
    const auto end = std::chrono::steady_clock::now() + patience;
    int isDone = 0;
    while (MPI_Test(&request, &isDone, MPI_STATUS_IGNORE) == MPI_SUCCESS && !isDone &&
           std::chrono::steady_clock::now() < end)
        ::sched_yield();
    if (isDone) return;
    if (auto ok = ranks_.wait(request); !ok) giveUp(ok.error());
}

template <class T, class IsEmpty>
void RankReduction::findOccupied(std::span<const T> elements, const IsEmpty& isEmpty) {
    const std::size_t spans = (elements.size() + span - 1) / span;
    header_.assign(firstBits + (spans + 63) / 64, 0);
    header_[stops] = wanted_.stop_requested();
    for (std::size_t i = 0; i < spans; ++i) {
        const auto part = elements.subspan(i * span, std::min(span, elements.size() - i * span));
        if (!std::ranges::all_of(part, isEmpty)) header_[firstBits + i / 64] |= std::uint64_t{1} << i % 64;
    }
}

/// False: nobody goes on.
bool RankReduction::agreeOnOccupied() {
    if (ranks_.size() > 1) {
        MPI_Request request;
        const int code = MPI_Iallreduce(MPI_IN_PLACE, header_.data(), int(header_.size()), MPI_UINT64_T,
                                        MPI_BOR, ranks_.handle(), &request);
        if (code != MPI_SUCCESS) giveUp({ErrorCode::Io, "a reduction did not begin.", {}});
        waitFor(request);
        traffic_.bytes += header_.size() * sizeof header_[0];
    }
    if (header_[stops] == 0) return true;
    agreed_.request_stop();
    return false;
}

template <class T>
void RankReduction::reduce(std::span<T> packed, MPI_Datatype type, MPI_Op op, cpu::Receivers to) {
    if (packed.empty()) return;
    const int count = int(packed.size());
    int code = MPI_SUCCESS;
    if (to == cpu::Receivers::Everybody)
        code = MPI_Allreduce(MPI_IN_PLACE, packed.data(), count, type, op, ranks_.handle());
    else if (shows())
        code = MPI_Reduce(MPI_IN_PLACE, packed.data(), count, type, op, 0, ranks_.handle());
    else
        code = MPI_Reduce(packed.data(), nullptr, count, type, op, 0, ranks_.handle());
    if (code != MPI_SUCCESS) giveUp({ErrorCode::Io, "a reduction failed.", {}});
    traffic_.bytes += packed.size_bytes();
    ++traffic_.reductions;
}

template <class T>
void RankReduction::reduceOccupied(std::vector<T>& packed, std::span<T> elements, std::size_t plane,
                                   MPI_Datatype type, MPI_Op op, cpu::Receivers to) {
    std::size_t occupied = 0;
    for (std::size_t word = firstBits; word < header_.size(); ++word)
        occupied += std::size_t(std::popcount(header_[word]));
    // What is nearly full is not worth packing.
    if (occupied * span >= plane / 8 * 7) return reduce(elements, type, op, to);
    const std::size_t planes = elements.size() / plane;
    packed.resize(occupied * span * planes);
    T* at = packed.data();
    for (std::size_t p = 0; p < planes; ++p) {
        inOccupied(header_, plane, [&](std::size_t first, std::size_t size) {
            std::copy_n(elements.data() + p * plane + first, size, at);
            std::fill(at + size, at + span, T{});
            at += span;
        });
    }
    reduce(std::span(packed), type, op, to);
    if (to == cpu::Receivers::WhoShows && !shows()) return;
    at = packed.data();
    for (std::size_t p = 0; p < planes; ++p) {
        inOccupied(header_, plane, [&](std::size_t first, std::size_t size) {
            std::copy_n(at, size, elements.data() + p * plane + first);
            at += span;
        });
    }
}

void RankReduction::least(std::span<cpu::Key> keys, cpu::Receivers to) {
    constexpr cpu::Key nothing = cpu::Key{cpu::infiniteOrder} << 32;
    findOccupied(std::span<const cpu::Key>(keys), [](cpu::Key key) { return key >= nothing; });
    if (!agreeOnOccupied() || ranks_.size() == 1) return;
    reduceOccupied(keys_, keys, keys.size(), MPI_INT64_T, MPI_MIN, to);
}

void RankReduction::total(cpu::SumPlanes& sums) {
    constexpr auto isNothing = [](auto weight) { return weight == 0; };
    std::uint64_t bits = 0;
    if (sums.isWide) {
        const std::span weights(sums.wide.data(), sums.pixels);
        findOccupied(std::span<const std::int64_t>(weights), isNothing);
        for (const std::int64_t weight : weights) bits |= std::uint64_t(weight);
    } else {
        const std::span weights(sums.narrow.data(), sums.pixels);
        findOccupied(std::span<const std::int32_t>(weights), isNothing);
        std::uint32_t all = 0;
        for (const std::int32_t weight : weights) all |= std::uint32_t(weight);
        bits = all;
    }
    header_[magnitudes] = sums.isWide ? bits | wideBits : bits;
    if (!agreeOnOccupied() || ranks_.size() == 1) return;
    // No rank's weights take more bits than all of theirs together; nothing else is more than 255 times as much.
    const int widest = std::bit_width(header_[magnitudes]) + 8 + std::bit_width(unsigned(ranks_.size()));
    const std::size_t all = sums.count * sums.pixels;
    if (widest < 32 && !sums.isWide)
        return reduceOccupied(narrow_, std::span(sums.narrow.data(), all), sums.pixels, MPI_INT32_T, MPI_SUM,
                              cpu::Receivers::WhoShows);
    sums.widen();
    reduceOccupied(wide_, std::span(sums.wide.data(), all), sums.pixels, MPI_INT64_T, MPI_SUM,
                   cpu::Receivers::WhoShows);
}

void RankReduction::join(std::span<std::uint32_t> words) {
    findOccupied(std::span<const std::uint32_t>(words), [](std::uint32_t word) { return word == 0; });
    if (!agreeOnOccupied() || ranks_.size() == 1) return;
    reduceOccupied(words_, words, words.size(), MPI_UINT32_T, MPI_BOR, cpu::Receivers::WhoShows);
}

}  // namespace scancast
