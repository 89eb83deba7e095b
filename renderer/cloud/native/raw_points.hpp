// Points of a native cloud between decoding and drawing: what a sample needs of them, on the scan's own grid. Pure functions.
// Pipeline: records → **raw points** → gathered → samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/import/octree/record_decoder.hpp"
#include "renderer/cloud/native/additive_tree.hpp"
#include "renderer/cloud/sample.hpp"

namespace scancast {

struct RawPoint {
    GridSteps at{};
    std::uint16_t intensity = 0;
    std::array<std::uint8_t, 3> color{};
    std::uint8_t classification = 0;
    bool operator==(const RawPoint&) const = default;
};

using RawPoints = std::shared_ptr<const std::vector<RawPoint>>;

/// What records mean, brought to `grid`. Malformed where a colour has 16 bits and `depth` says that none has, where positions are no finite
/// numbers, and where they lie beyond all steps of the grid.
Expected<std::vector<RawPoint>> rawPointsOf(std::span<const std::byte> records,
                                            const import_octree::RecordDecoder& decoder, LasColorDepth depth,
                                            const StepGrid& grid);

/// Where a point is among the samples of a node, on each axis; nullopt: elsewhere than in the node's box.
std::optional<std::array<std::uint16_t, 3>> onLattice(const RawPoint& point, const NodeLattice& lattice);

/// Samples in Morton order, the same for the same points in any order; without surfels. Malformed where a point lies elsewhere than the
/// node's box.
Expected<std::vector<Sample>> samplesOf(std::span<const RawPoint> points, const NodeLattice& lattice);

}  // namespace scancast
