// A style made ready for a device: colour maps, ranges and filters looked up, in cloud-relative units.
// Pipeline: view + cloud → **colour rule, filter** → device.
#pragma once

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// What `exposure=auto` means for a cloud whose look says nothing of it, in stops: dark or pale colours are brought
/// nearer to the middle, by one stop at most.
double automaticExposure(const CloudFacts& cloud);

/// The style with neither colour nor exposure left open: as the cloud's look has them; without one its own colours,
/// else intensity, else elevation.
Style decidedStyle(const Cloud& cloud, Style style);

/// Of a decided style. Unsupported when the cloud lacks the attribute (the message names those it has); InvalidArgument for a
/// colour map or range that does not exist.
Expected<ColorRule> colorRule(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint);

/// The values that have the first and the last colour of a decided style's ramp, in file coordinates: what the style says, or what
/// suits the cloud - and, where the colour is depth, the viewpoint. Nullopt where the colour has no ramp between two values.
std::optional<std::array<double, 2>> rampEnds(const Cloud& cloud, const Style& style,
                                              const Viewpoint& viewpoint);

/// What the style leaves of the cloud: its classes, what lies in its clip box and in its shapes, and nothing behind
/// mirrors unless it says so.
SampleFilter sampleFilter(const Cloud& cloud, const Style& style);

}  // namespace scancast
