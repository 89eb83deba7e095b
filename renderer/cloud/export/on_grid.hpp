// Which leaves have their points on the scan's grid by their samples alone. Pure functions.
#pragma once

#include <optional>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Lattice steps are those of the grid times a power of two, computed in doubles.
inline constexpr double sameStep = 1 + 1e-9;

/// Whether the samples of a leaf say less than the scan did.
bool rounds(const Node& leaf, const std::optional<ScanGrid>& grid);

}  // namespace scancast
