// Points between the reader and the octree: kept without loss and compactly until the scan's extent, and with
// it the grid, is known. Pipeline: import → **staging** → octree builder. Used by one thread, except where
// said.
#pragma once

#include <memory>
#include <span>

#include "renderer/cloud/grid.hpp"
#include "renderer/cloud/progress_meter.hpp"

namespace scancast {

/// Coordinates beyond ± this are refused: they are damage, and single precision cannot square them.
inline constexpr double farthestCoordinate = 1e15;

/// One batch, 20 bytes a point where the scan has a grid or is single precision, else 32.
struct StagedBatch {
    struct Rest {
        std::uint16_t intensity = 0;
        std::array<std::uint8_t, 3> color{255, 255, 255};
        std::uint8_t classification = 0;
        std::uint16_t normal = 0;
    };
    // Exactly one of these holds the positions.
    std::vector<std::array<std::int32_t, 3>> own;  ///< steps of the scan's own grid
    std::vector<glm::vec3> single;
    std::vector<glm::dvec3> full;
    std::vector<Rest> rest;
};

/// Everything that a scan's points have told, once all of them are read.
struct StagedScan {
    std::vector<StagedBatch> batches;
    std::uint64_t points = 0;
    std::uint64_t droppedPoints = 0;
    std::array<glm::dvec3, 2> bounds{glm::dvec3(1e300), glm::dvec3(-1e300)};  ///< file coordinates
    std::array<std::uint16_t, 2> intensityRange{65535, 0};
    std::array<std::uint64_t, 256> classCounts{};
    bool onOwnGrid = true;
    std::array<std::int64_t, 3> ownLow{}, ownHigh{};
};

/// Reads the source to its end; the next batch is read in a second thread while this one packs the last.
/// Errors: the source's own; Malformed for coordinates that no scan has; Empty.
Expected<StagedScan> stage(PointSource& source, ProgressMeter& progress);

/// The grid for these points.
Grid chooseGrid(const StagedScan& scan, const ScanHeader& header);

/// Puts all points on the grid, in parallel, in the order read; frees the batches on the way.
std::unique_ptr<BuildPoint[]> unstage(StagedScan& scan, const ScanHeader& header, const Grid& grid);

}  // namespace scancast
