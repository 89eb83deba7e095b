// Where a leaf's points are, as the scan has them: samples count steps from their node's corner, a scan counts steps of its own
// grid or has doubles. Pipeline: cloud file → **places** → export, pick, measure. *Thread safety*: any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Whether this leaf is too wide for 16 bits of the scan's grid, so that its samples round. Without a grid all do.
bool roundsPositions(const Node& leaf, const std::optional<ScanGrid>& grid);
/// The same on one axis.
bool roundsPositions(const Node& leaf, const std::optional<ScanGrid>& grid, int axis);

class ExactPlaces {
  public:
    /// Both outlive this. `file`: the cloud's; null for one that is in memory only.
    ExactPlaces(const CloudFacts& facts, const CloudFile* file);

    /// Of all points of a leaf, file coordinates, in the order of its samples: bit for bit what a reader of the scan computes
    /// (grid.origin + grid.step * whole number), or has, where isExact(). Reads what stands beside the samples where those
    /// round. Errors: the file's; Malformed where that is missing.
    Expected<void> of(std::uint32_t leaf, const Node& node, std::span<const Sample> samples,
                      std::span<glm::dvec3> places) const;
    bool isExact(const Node& leaf) const;
    /// As KeptPoint::precision.
    glm::dvec3 precision(const Node& leaf, const glm::dvec3& place) const;

  private:
    using Planes = std::optional<std::array<std::size_t, 3>>;
    template <class T, class Place>
    Expected<void> byPlanes(std::uint32_t leaf, std::size_t count, const Planes& planes, Place place) const;

    const CloudFacts& facts_;
    const CloudFile* file_;
    Planes grid_, doubles_;  ///< among the file's planes
};

}  // namespace scancast
