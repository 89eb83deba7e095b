// Positions of a batch while they wait: without loss, in as few bytes as that takes, and then on the grid of the octree. What becomes of
// a point depends on that point and on what is known of all of them, and never on the batches before it: several processes that read
// parts of a scan place it as one process does. Plain values and pure functions. Pipeline: batch → **staged positions** → grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Numbers on the scan's own grid.
using OwnSteps = std::array<std::int64_t, 3>;
struct OwnRange {
    OwnSteps low{}, high{};
};

/// Which of the scan's own steps these points have, of which there is at least one; nothing if the scan has no grid or some point does
/// not lie on it (header and points then contradict each other, and the points are right).
std::optional<OwnRange> ownRangeOf(const Positions& positions, const ScanHeader& header);

struct PackedPositions {
    enum class Kind : std::uint8_t {
        Steps,   ///< 3 × int32, steps of `grid`
        Single,  ///< 3 × float
        Full     ///< 3 × double
    };
    Kind kind = Kind::Steps;
    StepGrid grid;  ///< the one that the batch came with, which need not be the scan's
};
std::size_t bytesOf(PackedPositions::Kind kind);

/// Makes `out` as long as positions and `beside` bytes of each point are, and fills in the positions. `isOnOwnGrid`: what ownRangeOf()
/// said of them.
PackedPositions packPositions(const Positions& positions, const ScanHeader& header, bool isOnOwnGrid,
                              std::size_t beside, std::vector<std::byte>& out);

/// Packed positions on the octree's grid. `ownLow`: the lowest of the scan's own steps, where all of its points lie on its grid; else
/// null. Thread-safe.
void placePositions(const PackedPositions& packed, std::span<const std::byte> bytes, const ScanHeader& header,
                    const OwnSteps* ownLow, const Grid& grid, std::span<BuildPoint> out);

}  // namespace scancast
