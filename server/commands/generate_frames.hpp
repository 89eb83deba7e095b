// A simulated scan as a live source sends it: frame after frame, each a point stream of the scene, turned a little
// further than the one before. Deterministic. Pipeline: simulator → **frames** → pipe → `scancast serve --live`.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct FrameSeries {
    std::uint64_t frames = 1;  ///< 0 = until nobody reads any more
    double rate = 10;          ///< frames a second; 0 = as fast as they are read
    double turn = 3;           ///< degrees from frame to frame, about the middle, seen from above to the left
};

/// The points without normals, as cameras send them, turned by `degrees` about the vertical axis through `middle`.
PointBatch turned(const PointBatch& points, const glm::dvec3& middle, double degrees);

/// Reads the source once and keeps its points: about 30 bytes each. Returns how many frames were written; that nobody
/// reads any more is the end of a series without one, and else an error. Errors: the source's and the output's;
/// Cancelled when `interrupted` says so.
Expected<std::uint64_t> writeFrames(PointSource& source, const std::string& output, const FrameSeries& series,
                                    const std::function<bool()>& interrupted);

}  // namespace scancast
