// A style made ready for a device: colour maps, ranges and filters looked up, in cloud-relative units.
// Pipeline: view + cloud → **colour rule, filter** → device.
#pragma once

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// What a cloud is coloured by where a view leaves that open.
struct ColorChoice {
    ColorSource source = ColorSource::Rgb;
    bool byIntensity = false;
};

/// What `color=auto` means for the cloud: its own colours, else intensity, else elevation.
ColorChoice automaticColor(const Cloud& cloud);

/// What `exposure=auto` means for the cloud, in stops.
double automaticExposure(const Cloud& cloud);

/// The style with neither colour nor exposure left open.
Style decidedStyle(const Cloud& cloud, Style style);

/// Of a decided style. Unsupported when the cloud lacks the attribute (the message names those it has); InvalidArgument for a
/// colour map or range that does not exist.
Expected<ColorRule> colorRule(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint);

/// What the style leaves of the cloud: its classes, its clip box, and nothing behind mirrors unless it says
/// so.
SampleFilter sampleFilter(const Cloud& cloud, const Style& style);

}  // namespace scancast
