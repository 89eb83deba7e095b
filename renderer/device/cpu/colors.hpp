// Colours as the kernels want them: packed words and tables. Pure functions; made once per picture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/device/cpu/kernels/kernels.hpp"
#include "renderer/device/device.hpp"
#include "renderer/device/splat_plan.hpp"

namespace scancast::cpu {

/// Tables that a SplatPass points into; outlives the passes.
struct ColorTables {
    std::array<std::uint32_t, 256> ramp{};
    std::array<std::uint8_t, 256> classes{};
    std::vector<std::uint32_t> normals;  ///< by code; made once, when first asked for
};

/// Sets everything of the pass that concerns colour and class.
void setColors(const ColorRule& rule, const SampleFilter& filter, ColorTables& tables, SplatPass& pass);

/// One rgba per row of the whole picture's rows [firstRow, firstRow + rows), `height` rows in all: a gradient
/// runs over the whole picture, so tiles and windows continue each other.
std::vector<std::uint32_t> backgroundRows(const Background& background, int firstRow, int rows, int height);

}  // namespace scancast::cpu
