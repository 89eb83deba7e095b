// The points of a cloud file, as if it were a scan: each once, exactly as the file has them. Pipeline: cloud file →
// **points** → region → writer. Owned and used by one thread; blocks are decoded by several.
//
// Leaves hold the scan's own points, inner nodes averages of them: so leaves are read, depth first, a few at a time.
// The order of the points is the file's own, whatever reads it. Memory: a few leaves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "protocol/view/view.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct CloudPointsOptions {
    /// Nodes that lie outside are not read; of others, all points come. File coordinates.
    std::optional<ClipBox> clip{};
    bool estimatedNormals = false;  ///< those too that ingest estimated; else only the scan's own
};

/// header() says nothing but what is true: points and bounds are those of the nodes that are read (the points, of
/// the whole cloud; the bounds, of all of them). Columns are the kept ones, less those that positions and normals come
/// out of (exact_columns.hpp). read() fails as CloudFile does where a block is damaged.
std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options = {});

struct RoundedPoints {
    std::uint64_t points =
        0;               ///< whose leaves are wider than 16 bits of the scan's grid, or whose scan has none
    glm::dvec3 most{0};  ///< how far they may be from where they were, on each axis, in the file's unit
};
/// Of the leaves that touch the box. None where the cloud is exact.
RoundedPoints roundedPoints(const CloudFile& file, const std::optional<ClipBox>& clip);

}  // namespace scancast
