// How far each point of a cloud is from another epoch of the same place: `scancast distance` without the command line. Writes the cloud
// once more, as it is, with a column of distances. Pipeline: two cloud files → **distances** → cloud file. Called on any thread; uses a
// TBB arena of its own.
//
// The new file has all that the cloud had - the same samples in the same nodes, columns, companions, photos, look - and beside it a kept
// column, float32, with the distance of each point to the nearest point of the earlier epoch, exactly; and that column's companion for
// inner nodes. Points are where ExactPlaces says, so origins and grids may differ. The file's bytes depend on both clouds and on what is
// asked alone: neither on threads nor on the memory limit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct DistanceOptions {
    std::filesystem::path after{}, before{}, output{};
    std::string name = "distance";  ///< of the column
    double most = 5;                ///< what is farther away counts as so far, the file's unit; > 0
    glm::dvec3 shift{0};            ///< added to the earlier epoch's coordinates
    int threads = 0;                ///< 0 = all cores
    std::uint64_t memoryLimit = 0;  ///< bytes; 0 = half of the machine's memory
};

struct DistanceReport {
    KeptColumn column;
    std::uint64_t points = 0;
    std::uint64_t beyond = 0;  ///< points that are `most` away, or more
    double median = 0;         ///< about; all points
    std::string unit;          ///< "metre"; empty = not known
    std::uint64_t fileBytes = 0;
    std::vector<std::string> remarks;  ///< what was taken on no proof, one sentence each without an end
    double seconds = 0;
};

/// The least that memoryLimit may be.
inline constexpr std::uint64_t leastDistanceMemory = std::uint64_t(256) << 20;

/// Errors: CloudFile::open()'s; Unsupported for what is no cloud file, and for coordinates between which there are no distances
/// (degrees); InvalidArgument (fields `name`, `max`, `shift`, `memory-limit`, `before`) for what cannot be meant, and for epochs in
/// different coordinate reference systems; ResourceLimit (disk too full); Io; Cancelled. No output file is left by any of them.
Expected<DistanceReport> measureDistance(const DistanceOptions& options, const ProgressSink& progress = {},
                                         const std::stop_token& stop = {});

}  // namespace scancast
