// Who reads what: the points of all scans, one behind the other, divided among the ranks. Scans that can be read in part are cut where
// the shares end; others are read by the rank in whose share their middle lies. Pure function. Pipeline: headers → **shares** → staging.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scancast {

struct ReadableScan {
    std::optional<std::uint64_t>
        points;  ///< nullopt: not known; taken for as many as the others have on average
    bool hasParts = false;
    bool isOfFirstRank = false;  ///< whatever share it is in
};

struct ReadingShare {
    bool all = false;                    ///< all of the scan
    std::uint64_t first = 0, count = 0;  ///< else so many points from this one on; 0: nothing

    bool reads() const { return all || count > 0; }
    /// What a scan says of itself at its end is told by one rank.
    bool tells() const { return all || (count > 0 && first == 0); }
};

/// What `rank` of `ranks` reads of each of the scans.
std::vector<ReadingShare> shareReading(std::span<const ReadableScan> scans, int rank, int ranks);

}  // namespace scancast
