// The order in which runs had best be drawn. Pure functions. Place: cut → **order** → sample cache.
#pragma once

#include <span>
#include <vector>

#include "renderer/device/gl/memory/layer_memory.hpp"

namespace scancast::gl {

/// Roughly front to back: what is hidden then seldom needs an atomic operation, and nothing else depends on it. Indices in
/// the cut, of whose runs these are.
std::vector<std::uint32_t> frontToBack(const Cut& cut, std::span<const DrawnRun> runs,
                                       const Viewpoint& viewpoint);

}  // namespace scancast::gl
