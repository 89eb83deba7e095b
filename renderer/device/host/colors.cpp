#include "renderer/device/host/colors.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/cloud/sample.hpp"

namespace scancast {
namespace {

/// A unit vector's colour: -1 … 1 → 0 … 255 per axis. No normal is mid grey.
std::vector<std::uint32_t> makeNormalColors() {
    std::vector<std::uint32_t> colors(65536);
    for (std::uint32_t code = 0; code < 65536; ++code) {
        const glm::vec3 n = decodeNormal(static_cast<std::uint16_t>(code));
        const auto channel = [](float v) {
            return static_cast<std::uint8_t>(
                std::lround((std::fmin(std::fmax(v, -1.0f), 1.0f) * 0.5f + 0.5f) * 255));
        };
        colors[code] = packed({channel(n.x), channel(n.y), channel(n.z)});
    }
    return colors;
}

/// By code; the same for every picture.
std::span<const std::uint32_t> normalColors() {
    static const std::vector<std::uint32_t> colors = makeNormalColors();
    return colors;
}

}  // namespace

SplatColoring splatColoring(const ColorRule& rule) {
    switch (rule.source) {
        case ColorSource::Auto:
        case ColorSource::Rgb:
        case ColorSource::Cloud:  // in the samples already
            return rule.toned ? SplatColoring::Toned : SplatColoring::Rgb;
        case ColorSource::Intensity:
            return SplatColoring::Intensity;
        case ColorSource::Elevation:
            return SplatColoring::Elevation;
        case ColorSource::Classification:
            return SplatColoring::Classification;
        case ColorSource::Normal:
            return SplatColoring::Normal;
        case ColorSource::Curvature:
            return SplatColoring::Curvature;
        case ColorSource::Infrared:
            return SplatColoring::Infrared;
        case ColorSource::Depth:
            return SplatColoring::Depth;
        case ColorSource::Lod:
        case ColorSource::Visibility:  // of its own pass
        case ColorSource::Column:      // is intensity by now
        case ColorSource::Flat:
            return SplatColoring::PerRun;
    }
    return SplatColoring::Rgb;
}

ColorTables colorTables(const ColorRule& rule, const SampleFilter& filter) {
    ColorTables tables;
    for (std::size_t i = 0; i < 256; ++i) tables.ramp[i] = packed(rule.ramp[i]);
    if (rule.byIntensity) std::ranges::copy(rule.byIntensity->factors, tables.factors.begin());
    if (rule.source == ColorSource::Normal) tables.normals = normalColors();
    tables.byClass = filter.classes.has_value();
    if (filter.classes) {
        for (std::size_t i = 0; i < 256; ++i) tables.classes[i] = (*filter.classes)[i] ? 1 : 0;
    }
    return tables;
}

float indexScale(double low, double high) {
    const double width = high - low;
    return std::isnormal(width) ? static_cast<float>(255.0 / width) : 0.0f;
}

void setColors(const ColorRule& rule, SplatPass& pass) {
    pass.coloring = splatColoring(rule);
    pass.colorLow = static_cast<float>(rule.low);
    pass.colorScale = indexScale(rule.low, rule.high);
    pass.byIntensity = rule.byIntensity.has_value();
    if (!rule.byIntensity) return;
    pass.intensityLow = static_cast<float>(rule.byIntensity->low);
    pass.intensityScale = indexScale(rule.byIntensity->low, rule.byIntensity->high);
}

std::vector<std::uint32_t> backgroundRows(const Background& background, int firstRow, int rows, int height) {
    std::vector<std::uint32_t> out(static_cast<std::size_t>(rows), 0);
    if (background.kind == Background::Kind::Transparent) return out;
    const bool gradient = background.kind == Background::Kind::Gradient;
    for (int i = 0; i < rows; ++i) {
        // Pixel centres at +0.5: weights in halves of a row.
        const int below = gradient ? 2 * (firstRow + i) + 1 : 0;
        const int above = 2 * height - below;
        Rgb8 color;
        for (std::size_t c = 0; c < 3; ++c) {
            color[c] = static_cast<std::uint8_t>(
                (background.top[c] * above + background.bottom[c] * below + height) / (2 * height));
        }
        out[static_cast<std::size_t>(i)] = packed(color) | 0xff000000u;
    }
    return out;
}

}  // namespace scancast
