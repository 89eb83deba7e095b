// From a frame of a live source to a cloud, as quickly as possible: a depth camera sends the next one in a thirtieth
// of a second. One pass each: order → surface → octree, where buildCloud() stages, counts, divides, and estimates
// surfels of each point's own neighbours. Pipeline: live frames → **cloud** → catalog. Called on any thread.
//
// What all frames of a source have in common is decided by its first one and kept, so that camera and colours stay
// while the points change.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Of all clouds of one source.
struct FrameBasis {
    glm::dvec3 origin{0};
    std::optional<UsualRanges> usual;
    std::array<std::uint16_t, 2> intensityRange{0, 65535};
    std::optional<Look> look;
};
/// What the clouds after this one keep.
FrameBasis basisOf(const Cloud& first);

struct FrameOptions {
    std::string title{};
    int threads = 0;                    ///< 0 = all cores; the result does not depend on it
    bool surfels = true;                ///< estimate radius and normal of every sample
    const FrameBasis* basis = nullptr;  ///< of the frames before; null = this is the first one
};

/// What one point takes while its frame is built, and then in the cloud: its bytes on top of the frame's own.
inline constexpr std::uint64_t bytesToBuildFramePoint = 200;

/// Errors: Empty; Malformed for coordinates that no scan has; ResourceLimit when memory runs out, and beyond 4 billion
/// points.
Expected<std::shared_ptr<const Cloud>> buildFrameCloud(const PointFrame& frame, const FrameOptions& options);

}  // namespace scancast
