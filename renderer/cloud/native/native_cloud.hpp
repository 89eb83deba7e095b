// A scan in an additive octree as a cloud to look at, without ingest: facts and nodes at once, points as views want them (decision 29). What
// it knows of the scan as a whole - colours, ranges, classes, the look - is known of its upper levels, which are read when it is opened.
// Any thread; opening waits for the source. Pipeline: voxel source (copc/, ept/) → **native cloud** → residency.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/assumed_crs.hpp"
#include "renderer/cloud/native/gathered_points.hpp"
#include "renderer/cloud/native/voxel_source.hpp"

namespace scancast {

struct NativeCloudOptions {
    std::filesystem::path name;          ///< what path() says and messages call it
    std::string title;                   ///< for people
    std::string identity;                ///< of what is read, beside its bytes: part of the revision
    bool surfels = true;                 ///< normals and radii are estimated, of each node on the way
    std::uint64_t upperPoints = 50'000;  ///< from so many on, upper levels tell enough of the scan
    /// Of points that are kept for the nodes below them; empty: 64 MB of its own.
    std::shared_ptr<GatheredMemory> memory{};
    std::optional<AssumedCrs> crs{};  ///< taken for the scan's, whatever it says
    std::vector<Mirror> mirrors{};    ///< that stand beside the scan
    /// How it is seen when nobody says anything, by its upper levels; empty: it has no look.
    std::function<std::optional<Look>(const std::shared_ptr<const Cloud>& upper)> look{};
};

/// Reads the upper levels and plants the tree. `source` may be an error without the scan's name. Errors, with the scan's name: Truncated,
/// Malformed, Unsupported, Empty, Importer; ResourceLimit, with the way out; the source's.
Expected<std::shared_ptr<const CloudFile>> openNativeCloud(Expected<std::unique_ptr<VoxelSource>> source,
                                                           NativeCloudOptions options);

}  // namespace scancast
