// The scan simulator behind `scancast generate`: points as a scanner would record them, on scenes whose truth is
// known. Feeds the demo, the oracles and the scale tests; deterministic by seed; streamed, any number of points.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

enum class PointOrder : std::uint8_t {
    Scan,    ///< scan line after scan line, station after station
    Random,  ///< a uniform shuffle, as after merging and thinning
};

struct SceneOptions {
    std::string scene;              ///< town, room, sphere, plane
    std::uint64_t points = 1'000'000;
    std::uint64_t seed = 1;
    PointOrder order = PointOrder::Scan;
    double noise = 1;               ///< factor on the scene's own range noise; 0 = exact surface
};

struct SceneInfo {
    std::string_view name;
    std::string_view summary;
};

std::span<const SceneInfo> scenes();

/// A source that yields exactly `points` points. Errors: NotFound naming the scenes; InvalidArgument.
Expected<std::unique_ptr<PointSource>> simulate(const SceneOptions& options);

}  // namespace scancast
