// What the colours of a map mean, and the picture that says so: classes by name, a ramp with the values at its ends, clouds by title.
// Pure functions; any thread; the same bytes everywhere. Pipeline: cloud + planned view → **legend** → frame → encode.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/image/frame.hpp"
#include "renderer/plan.hpp"

namespace scancast {

struct MapLegend {
    struct Row {
        std::optional<Rgb8> color;  ///< nullopt: a line of text alone
        std::string text;
        bool operator==(const Row&) const = default;
    };
    std::string title;                  ///< with its unit, where it has one: "Elevation (m)"
    std::vector<Rgb8> ramp{};           ///< from the low end to the high one; empty: there is none
    std::array<std::string, 2> ends{};  ///< of the ramp: "34.2"
    std::vector<Row> rows{};
    bool operator==(const MapLegend&) const = default;
};

/// Rows of classes and clouds that are listed; what is more is counted in a row.
inline constexpr std::size_t mostLegendRows = 40;

/// Of what the view shows: classes and clouds that are left out have no row. Never empty: colours that stand for nothing but
/// themselves are named.
MapLegend mapLegend(const Cloud& cloud, const PlannedView& planned);

/// Two texts that tell them apart, with as many digits each: "34.2", "101.7".
std::array<std::string, 2> legendEnds(const std::array<double, 2>& values);

/// px.
struct LegendSize {
    int width = 0, height = 0;
};
LegendSize legendSize(const MapLegend& legend);

/// `background`: nullopt = transparent. Letters are dark, on dark ground light.
Frame drawLegend(const MapLegend& legend, const std::optional<Rgb8>& background);

}  // namespace scancast
