// A style made ready for a device: colour maps, ranges and filters looked up, in cloud-relative units.
// Pipeline: view + cloud → **colour rule, filter** → device.
#pragma once

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// The best colour source that the cloud has: its own colours, else intensity, else elevation.
ColorSource bestColorSource(const Attributes& attributes);

/// Unsupported when the cloud lacks the attribute (the message names those it has); InvalidArgument for a
/// colour map or range that does not exist.
Expected<ColorRule> colorRule(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint);

/// What the style leaves of the cloud: its classes, its clip box, and nothing behind mirrors unless it says
/// so.
SampleFilter sampleFilter(const Cloud& cloud, const Style& style);

}  // namespace scancast
