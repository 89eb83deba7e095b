// What `ingest --exact` keeps beside the samples, and under which names: everything that a sample rounds. Plain values,
// shared by who writes it (build/) and who takes it out again (export/).
//
// Positions are whole numbers on the scan's grid (CloudFacts::grid), which samples have exactly but in leaves that are
// too wide for 16 bits: there, planes beside the samples have them. A scan without a grid has columns of doubles.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

using ThreeNames = std::array<std::string_view, 3>;

/// Columns, uint16: colours as LAS has them.
inline constexpr ThreeNames fullColorNames{"red_16", "green_16", "blue_16"};
/// Columns, float32: the scan's own normals, which samples have to a degree.
inline constexpr ThreeNames exactNormalNames{"exact_nx", "exact_ny", "exact_nz"};
/// Columns, float64: positions of scans without one grid.
inline constexpr ThreeNames exactPositionNames{"exact_x", "exact_y", "exact_z"};
/// Companions, int32 of points: file coordinate = grid.origin + grid.step * value.
inline constexpr ThreeNames gridPlaneNames{"grid_x", "grid_y", "grid_z"};

std::array<ValuePlane, 3> gridPlanes();
/// Whether the cloud file has those companions.
bool hasGridPlanes(const CloudFacts& facts);

/// Which columns have these names and this type; nullopt unless all three are there.
std::optional<std::array<std::size_t, 3>> findColumns(std::span<const Column> columns,
                                                      const ThreeNames& names, ColumnType type);

}  // namespace scancast
