#include "ranks/ingest/reading_shares.hpp"

#include <algorithm>

namespace scancast {

namespace {

__extension__ using Wide = unsigned __int128;

std::uint64_t beginOf(int rank, int ranks, std::uint64_t points) {
    return std::uint64_t(Wide(points) * unsigned(rank) / unsigned(ranks));
}

}  // namespace

std::vector<ReadingShare> shareReading(std::span<const ReadableScan> scans, int rank, int ranks) {
    Wide known = 0;
    std::uint64_t knowing = 0;
    for (const ReadableScan& scan : scans)
        if (scan.points) known += *scan.points, ++knowing;
    const std::uint64_t average =
        knowing > 0 ? std::max<std::uint64_t>(1, std::uint64_t(known / knowing)) : 1;
    const auto weightOf = [&](const ReadableScan& scan) { return scan.points.value_or(average); };
    std::uint64_t all = 0;
    for (const ReadableScan& scan : scans) all += weightOf(scan);
    const std::uint64_t begin = beginOf(rank, ranks, all), end = beginOf(rank + 1, ranks, all);

    std::vector<ReadingShare> shares;
    std::uint64_t before = 0;
    for (const ReadableScan& scan : scans) {
        const std::uint64_t weight = weightOf(scan), middle = before + weight / 2;
        ReadingShare& share = shares.emplace_back();
        if (scan.isOfFirstRank) {
            share.all = rank == 0;
        } else if (scan.hasParts && scan.points) {
            const std::uint64_t first = std::clamp(begin, before, before + weight),
                                last = std::clamp(end, before, before + weight);
            share.first = first - before;
            share.count = last - first;
        } else {
            // Scans of no weight behind all others are the last rank's.
            share.all = middle >= begin && (middle < end || rank == ranks - 1);
        }
        before += weight;
    }
    return shares;
}

}  // namespace scancast
