// The points of a cloud file, as if it were a scan: each once, exactly as the file has them. Pipeline: cloud file →
// **points** → writer. Owned and used by one thread; blocks are decoded by several.
//
// Leaves hold the scan's own points, inner nodes averages of them: so leaves are read, depth first, a few at a time.
// The order of the points is the file's own, whatever reads it. Memory: a few leaves.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "renderer/cloud/export/corridor.hpp"
#include "renderer/cloud/export/region.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct CloudPointsOptions {
    /// Only points in it: nodes outside are not read, and of those inside no point is looked at. Empty: everything.
    std::shared_ptr<const RegionTest> region{};
    /// Only points in it, too; each has its station and its offset, in two columns before all others.
    std::shared_ptr<const Corridor> corridor{};
    bool estimatedNormals = false;  ///< those too that ingest estimated; else only the scan's own
    bool columns = true;            ///< the kept ones; without, blocks of them are not read
    /// Asked before every leaf, whose blocks may have to come over a network; then read() is Cancelled.
    std::stop_token stop{};
};
inline constexpr std::string_view stationColumn = "station", offsetColumn = "offset";

/// A leaf that points are wanted of.
struct WantedLeaf {
    std::uint32_t node = 0;
    bool whole = false;  ///< all of its points are wanted: their number is the node's
};
/// Depth first, as their points come. Not all of them where it is stopped meanwhile.
std::vector<WantedLeaf> wantedLeaves(const CloudFile& file, const CloudPointsOptions& options);
/// Where a leaf's points can be, file coordinates: positions on the scan's grid may lie a step beside what samples say.
std::array<glm::dvec3, 2> reachOf(const CloudFile& file, const Node& leaf);

/// header() says nothing but what is true: points, where no point has to be looked at to know their number; bounds are the
/// whole cloud's, and only without a region and a corridor. Columns are the kept ones, less those that positions and normals
/// come out of (exact_columns.hpp). read() fails as CloudFile does where a block is damaged.
std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options = {});
/// Of these leaves alone.
std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options, std::vector<WantedLeaf> leaves);

struct RoundedPoints {
    std::uint64_t points =
        0;               ///< whose leaves are wider than 16 bits of the scan's grid, or whose scan has none
    glm::dvec3 most{0};  ///< how far they may be from where they were, on each axis, in the file's unit
};
/// Of the leaves that points are wanted of. None where the cloud is exact.
RoundedPoints roundedPoints(const CloudFile& file, const CloudPointsOptions& options);

}  // namespace scancast
