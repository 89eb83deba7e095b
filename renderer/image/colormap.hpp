// The well-known colour ramps: viridis, turbo, grey; and the tints of ASPRS classes and of levels of detail.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/view.hpp"

namespace scancast {

using Ramp = std::array<Rgb8, 256>;

std::optional<Ramp> colormap(std::string_view name);
std::span<const std::string_view> colormapNames();
/// Customary colours of the ASPRS classes: ground brown, vegetation greens, building red-grey, water blue …
const Ramp& classificationColors();
/// One clearly different colour per octree level.
const Ramp& levelColors();

}  // namespace scancast
