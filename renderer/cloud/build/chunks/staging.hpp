// Points between the reader and the octree: kept without loss and compactly until the scan's extent, and with
// it the grid, is known. Pipeline: import → **staging** → chunks. Used by one thread, except where said.
#pragma once

#include <memory>
#include <span>
#include <stop_token>

#include "renderer/cloud/build/chunks/staged_positions.hpp"
#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/build/progress_meter.hpp"
#include "renderer/cloud/build/value_ranges.hpp"
#include "renderer/cloud/build/workspace.hpp"

namespace scancast {

/// Coordinates beyond ± this are refused: they are damage, and single precision cannot square them.
inline constexpr double farthestCoordinate = 1e15;

/// Of what the builder takes along beside each point: its row of columns, then its near infrared, if there is any.
std::size_t stagedRowBytes(const ScanHeader& header);

/// One batch: its positions, then everything else of the points, then their rows (stagedRowBytes).
struct StagedBatch {
    struct Rest {
        std::uint16_t intensity = 0;
        std::array<std::uint8_t, 3> color{255, 255, 255};
        std::uint8_t classification = 0;
        std::uint16_t normal = 0;  ///< with `sights`, until it is estimated: the direction to the scanner
    };
    PackedPositions positions;
    std::uint32_t points = 0;
    Workspace::Buffer bytes;
};

/// Everything that a scan's points have told, once all of them are read.
struct StagedScan {
    std::vector<StagedBatch> batches;
    std::uint64_t points = 0;
    std::uint64_t droppedPoints = 0;
    std::array<glm::dvec3, 2> bounds{glm::dvec3(1e300), glm::dvec3(-1e300)};  ///< file coordinates
    std::vector<std::string> notes;                                           ///< the source's
    ValueRanges values;
    std::array<std::uint64_t, 256> classCounts{};
    std::vector<std::array<double, 2>> columnRanges;  ///< of header.columns, scaled
    std::vector<ValueSketch> columnSketches;          ///< of the same
    std::vector<Station> stations;                    ///< the source's
    std::vector<Photo> photos;                        ///< the source's, those whose bytes came
    std::uint64_t sighted = 0;  ///< points of which it is known where they were recorded from
    bool onOwnGrid = true;
    std::array<std::int64_t, 3> ownLow{}, ownHigh{};

    /// Everything that points tell and that can be joined: not batches, not what the source says.
    template <class Visit>
    void forLearnt(Visit visit) {
        visit(points);
        visit(bounds);
        values.forFields(visit);
        visit(classCounts);
        visit(columnRanges);
        for (ValueSketch& sketch : columnSketches) sketch.forFields(visit);
        visit(sighted);
        visit(onOwnGrid);
        visit(ownLow);
        visit(ownHigh);
    }
    /// Another part of the same scan, with the same columns: as if this had staged its points, too. Without batches.
    void join(const StagedScan& other);
};

/// Reads the source to its end; the next batch is read in a second thread while this one packs the last. `sights`: normals will be
/// estimated, so in their place stands, as a normal is encoded, the direction from each point to where it was recorded from; noNormal
/// where nobody knows.
/// Errors: the source's own; Malformed for coordinates that no scan has; Empty; the workspace's; Cancelled.
Expected<StagedScan> stage(PointSource& source, Workspace& workspace, ProgressMeter& progress,
                           const std::stop_token& stop, bool sights = false);

// Its steps, for several processes that read parts of a scan.

/// stage() without its end: a part may be empty, and is joined with others.
Expected<StagedScan> stagePart(PointSource& source, Workspace& workspace, ProgressMeter& progress,
                               const std::stop_token& stop, bool sights = false);
/// What the source says at its end.
void takeTold(const PointSource& source, StagedScan& scan);
/// All parts are joined. Errors: Empty.
Expected<void> settleStaged(StagedScan& scan);

/// The grid for these points.
Grid chooseGrid(const StagedScan& scan, const ScanHeader& header);

/// A batch's points on the grid, and their rows. `bytes` are the batch's. Thread-safe.
void placeOnGrid(const StagedBatch& batch, std::span<const std::byte> bytes, const StagedScan& scan,
                 const ScanHeader& header, const Grid& grid, std::span<BuildPoint> out);
/// The rows among a batch's bytes.
std::span<const std::byte> rowsOf(const StagedBatch& batch, std::span<const std::byte> bytes);

}  // namespace scancast
