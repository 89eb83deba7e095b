// An octree whose description and hierarchy were read and found sound: what is known of its scan, and its points, piece by
// piece. A piece is a node's file, or its part of a file. *Thread safety*: const functions from any thread. Pipeline:
// folder → **octree** → pieces, on many threads → point stream.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "importers/octree/tree/tree_files.hpp"
#include "protocol/error.hpp"
#include "renderer/cloud/import/octree/record_decoder.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_octree {

/// What is wanted of a piece.
struct Wanted {
    std::uint64_t points =
        std::numeric_limits<std::uint64_t>::max();  ///< of the first; perhaps some more come
    bool onlyColors = false;                        ///< records may be wrong in everything else
};

class Octree {
  public:
    /// Whole records, at most sliceRecords() of them; false = no more are wanted. The decoder is there during the call.
    using TakeRecords = std::function<Expected<bool>(const RecordDecoder&, std::span<const std::byte>)>;

    virtual ~Octree() = default;

    const ScanHeader& header() const { return header_; }
    /// What whoever reads the scan should hear.
    const std::vector<std::string>& notes() const { return notes_; }
    /// False when no number of a colour can be above 255.
    bool mayHaveWideColors() const { return mayHaveWideColors_; }

    /// Whether all positions are steps of the header's grid.
    bool areSteps() const { return areSteps_; }

    virtual std::size_t pieces() const = 0;
    /// Bytes that read() takes, at most, with what becomes of its records while they wait.
    virtual std::uint64_t memoryOf(std::size_t piece) const = 0;
    /// Its points, in order. Errors name its file.
    virtual Expected<void> read(std::size_t piece, const Wanted& wanted, const TakeRecords& take) const = 0;

  protected:
    ScanHeader header_;
    std::vector<std::string> notes_;
    bool mayHaveWideColors_ = false, areSteps_ = false;
};

/// Records that are decoded at once: as many as fit into some megabytes with all that becomes of them.
std::size_t sliceRecords(std::uint32_t recordBytes);
/// Bytes of the slices of so many points that are there at once, and of what becomes of them.
std::uint64_t slicesMemory(std::uint32_t recordBytes, std::uint64_t points);

/// Hands over `points` records that stand in a file one behind the other, from `at` on; see Octree::read().
Expected<void> readPlainRecords(const TreeFile& file, std::uint64_t at, std::uint64_t points,
                                const Wanted& wanted, const RecordDecoder& decoder,
                                const Octree::TakeRecords& take);

/// What a JSON file says of the number of points, and what its octree holds: `entry` "ept.json" says `said`. The header
/// declares it where both agree; else a note tells.
void takeDeclaredPoints(const std::string& entry, std::optional<std::uint64_t> said, std::uint64_t held,
                        ScanHeader& header, std::vector<std::string>& notes);

}  // namespace scancast::import_octree
