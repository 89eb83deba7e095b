// Colours as devices want them: packed words and tables. Pure functions; made once per picture.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast {

/// r | g << 8 | b << 16, as samples and payloads hold it.
inline std::uint32_t packed(const Rgb8& c) {
    return static_cast<std::uint32_t>(c[0]) | static_cast<std::uint32_t>(c[1]) << 8 |
           static_cast<std::uint32_t>(c[2]) << 16;
}

SplatColoring splatColoring(const ColorRule& rule);

/// What samples look their colours and classes up in.
struct ColorTables {
    std::array<std::uint32_t, 256> ramp{};
    std::array<std::uint32_t, 256> factors{};  ///< ColorRule::byIntensity; else zeros
    std::array<std::uint8_t, 256> classes{};   ///< 1 = drawn
    bool byClass = false;                      ///< not all classes are drawn
    std::span<const std::uint32_t> normals{};  ///< by code; only where colours are normals'
};

ColorTables colorTables(const ColorRule& rule, const SampleFilter& filter);

/// From a value above `low` to an index of a table; 0 where the range has no width: everything is at the
/// table's beginning.
float indexScale(double low, double high);
/// Sets what of colours is the same for all samples.
void setColors(const ColorRule& rule, SplatPass& pass);

/// One rgba per row of the whole picture's rows [firstRow, firstRow + rows), `height` rows in all: a gradient
/// runs over the whole picture, so tiles and windows continue each other.
std::vector<std::uint32_t> backgroundRows(const Background& background, int firstRow, int rows, int height);

}  // namespace scancast
