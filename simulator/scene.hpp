// The scan simulator behind `scancast generate`: points as a scanner would record them, on scenes whose truth
// is known. Feeds the demo, the oracles and the scale tests; deterministic by seed; streamed, any number of
// points.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

enum class PointOrder : std::uint8_t {
    Scan,    ///< scan line after scan line, station after station
    Random,  ///< a uniform shuffle, as after merging and thinning
};

struct SceneOptions {
    std::string scene;  ///< one of scenes()
    std::uint64_t points = 1'000'000;
    std::uint64_t seed = 1;
    PointOrder order = PointOrder::Scan;
    double noise = 1;  ///< factor on the scene's own range noise; 0 = exact surface
    /// Added to every coordinate; by default 0, but for the town a place in UTM.
    std::optional<glm::dvec3> origin = std::nullopt;
    int threads = 0;  ///< 0 = all cores; the points do not depend on it
};

struct SceneInfo {
    std::string_view name;
    std::string_view summary;
};

std::span<const SceneInfo> scenes();

/// A good place to look from, relative to the scene's origin; Z is up.
struct SceneView {
    std::string_view scene, name;
    glm::dvec3 eye, target;
    double fov = 50;  ///< vertical, degrees
};

/// The views of a scene that pictures of it are compared in, the first one shows the whole; empty for unknown
/// scenes.
std::span<const SceneView> sceneViews(std::string_view scene);

/// A source that yields exactly `points` points, in memory that does not grow with their number. Each point
/// is a pure function of (scene, points, seed, noise, its number), so both orders give the same set. The
/// header's bounds are a promise: no point lies outside. Errors: NotFound naming the scenes; InvalidArgument;
/// ResourceLimit.
Expected<std::unique_ptr<PointSource>> simulate(const SceneOptions& options);

/// The mirrors of a scene, in the coordinates of its points; empty for scenes without and for unknown ones.
std::vector<Mirror> sceneMirrors(const SceneOptions& options);

}  // namespace scancast
