// Small clouds of points that a test computes itself, as octree leaves and as a cut, without the builder:
// what a device is given is then known exactly.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/octree.hpp"
#include "renderer/cloud/surfels/surfels.hpp"
#include "renderer/select/select.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast::test {

struct AnalyticPoint {
    glm::dvec3 position{0};
    Rgb8 rgb{255, 255, 255};
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    std::uint16_t normal = noNormal;
    std::optional<Surfel> surfel = std::nullopt;  ///< sets the normal, too
};

/// Owns the samples that its cut points to; move-only.
class AnalyticCloud {
  public:
    /// Leaves of at most `leafPoints`, split at medians; samples lie in Morton order within a leaf, or as
    /// they come from the split. Every leaf gets the same `spacing`.
    AnalyticCloud(std::span<const AnalyticPoint> points, double spacing, std::uint32_t leafPoints = 4096,
                  bool mortonOrder = true);
    AnalyticCloud(const AnalyticCloud&) = delete;
    AnalyticCloud(AnalyticCloud&&) = default;

    const Cut& cut() const { return cut_; }
    /// Adds the other's runs behind the own ones, as one cut (the other must stay alive).
    Cut joined(const AnalyticCloud& other) const;

  private:
    void addLeaf(std::span<const AnalyticPoint> points, double spacing);

    std::vector<Node> nodes_;
    std::vector<Sample> samples_;
    std::vector<CurvatureCode> curvatures_;  ///< of all samples where a surfel bends, else of none
    Cut cut_;
};

/// Camera at `eye` looking at `target`, Z up (or Y where that is the view direction); near and far as given.
Viewpoint lookAt(glm::dvec3 eye, glm::dvec3 target, int width, int height, double fovDegrees = 60,
                 double near = 1e-3, double far = 1e6);
/// The same without perspective; `viewHeight` cloud units fill the picture's height.
Viewpoint lookAtOrthographic(glm::dvec3 eye, glm::dvec3 target, int width, int height, double viewHeight,
                             double near = 1e-3, double far = 1e6);

/// A sequence of numbers that is the same everywhere: splitmix64.
class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next();
    double uniform(double low = 0, double high = 1);
    glm::dvec3 onSphere();
    Rgb8 color();

  private:
    std::uint64_t state_;
};

}  // namespace scancast::test
