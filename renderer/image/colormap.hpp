// The well-known colour ramps: viridis, turbo, grey; and the tints of ASPRS classes and of levels of detail.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "protocol/view/view.hpp"

namespace scancast {

using Ramp = std::array<Rgb8, 256>;

/// Of colormapNames; nullopt for another name.
std::optional<Ramp> colormap(std::string_view name);
/// Customary colours of the ASPRS classes: ground brown, vegetation greens, building red-grey, water blue …
const Ramp& classificationColors();
/// From hollow to convex: blue, the grey of what is flat, red.
const Ramp& curvatureColors();
/// One clearly different colour per octree level; after so many levels they begin again.
inline constexpr std::size_t levelCycle = 10;
const Ramp& levelColors();

}  // namespace scancast
