#include "renderer/map/map_legend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/classification.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/image/colormap.hpp"
#include "renderer/style.hpp"
#include "renderer/together/together.hpp"

namespace scancast {
namespace {

std::string hexOf(const Rgb8& color) {
    return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

std::string capitalized(std::string_view text) {
    std::string made(text);
    if (!made.empty() && made[0] >= 'a' && made[0] <= 'z') made[0] = char(made[0] - 'a' + 'A');
    return made;
}

/// "m", "ft", "ft (US)", or the word that there is.
std::string shortUnit(const Cloud& cloud) {
    const std::string unit = crsUnit(cloud.crsWkt, cloud.crsEpsg);
    if (unit == "metre") return "m";
    if (unit == "foot") return "ft";
    if (unit == "US survey foot") return "ft (US)";
    // Heights above degrees are in something else, which nobody says.
    return unit == "degree" ? std::string() : unit;
}

std::string withUnit(std::string title, const std::string& unit) {
    return unit.empty() ? title : title + " [" + unit + "]";
}

void addRows(MapLegend& legend, std::vector<MapLegend::Row> rows) {
    const std::size_t more = rows.size() > mostLegendRows ? rows.size() - mostLegendRows : 0;
    rows.resize(rows.size() - more);
    legend.rows = std::move(rows);
    if (more > 0) legend.rows.push_back({std::nullopt, fmt::format("and {} more", more)});
}

void addClasses(const Cloud& cloud, const Style& style, MapLegend& legend) {
    std::vector<MapLegend::Row> rows;
    for (std::size_t c = 0; c < cloud.classCounts.size(); ++c) {
        if (cloud.classCounts[c] == 0) continue;
        if (style.classes && std::ranges::find(*style.classes, std::uint8_t(c)) == style.classes->end())
            continue;
        rows.push_back({classificationColors()[c], fmt::format("{} {}", c, className(std::uint8_t(c)))});
    }
    addRows(legend, std::move(rows));
}

void addClouds(const Cloud& cloud, MapLegend& legend) {
    if (!cloud.together) {
        legend.rows.push_back({cloudColors.front(), cloud.title});
        return;
    }
    std::vector<MapLegend::Row> rows;
    const auto& members = cloud.together->members;
    for (std::size_t i = 0; i < members.size(); ++i) {
        const TogetherMember& member = members[i];
        if (member.hidden) continue;
        const std::string& title = member.cloud->title;
        rows.push_back(
            {member.tint.value_or(cloudColors[i % cloudColors.size()]), title.empty() ? member.name : title});
    }
    addRows(legend, std::move(rows));
}

void addRamp(const PlannedView& planned, MapLegend& legend) {
    if (!planned.colorRange) return;
    legend.ramp.assign(planned.color.ramp.begin(), planned.color.ramp.end());
    legend.ends = legendEnds(*planned.colorRange);
}

void addHiddenPoints(const PlannedView& planned, MapLegend& legend) {
    for (const Pass& pass : planned.passes)
        if (const auto* found = std::get_if<VisibilityPass>(&pass))
            legend.rows = {{found->foreground, "visible"},
                           {found->hidden, "hidden"},
                           {found->hole, "holes between points"}};
}

/// What a column's values are, for people: its description where that says more than its name.
std::string columnText(const Cloud& cloud, const std::string& name) {
    for (const KeptColumn& kept : cloud.columns)
        if (kept.column.name == name && kept.column.description != name) return kept.column.description;
    return {};
}

}  // namespace

std::array<std::string, 2> legendEnds(const std::array<double, 2>& values) {
    const double between = std::abs(values[1] - values[0]);
    const int decimals = between > 0 ? std::clamp(2 - int(std::floor(std::log10(between))), 0, 9) : 3;
    const auto text = [&](double value) {
        std::string made = fmt::format("{:.{}f}", value, decimals);
        if (made.find('.') != std::string::npos) {
            made.erase(made.find_last_not_of('0') + 1);
            if (made.back() == '.') made.pop_back();
        }
        return made == "-0" ? std::string("0") : made;
    };
    return {text(values[0]), text(values[1])};
}

MapLegend mapLegend(const Cloud& cloud, const PlannedView& planned) {
    const Style style = decidedStyle(cloud, planned.view.style);
    const std::string unit = shortUnit(cloud);
    MapLegend legend;
    switch (style.color) {
        case ColorSource::Auto:
        case ColorSource::Rgb:
            legend.title = "Colours of the scan";
            break;
        case ColorSource::Infrared:
            legend.title = "Colour infrared";
            for (const char* text : {"red: near infrared", "green: red", "blue: green"})
                legend.rows.push_back({std::nullopt, text});
            break;
        case ColorSource::Intensity:
            legend.title = "Intensity";
            addRamp(planned, legend);
            break;
        case ColorSource::Elevation:
            legend.title = withUnit("Elevation", unit);
            addRamp(planned, legend);
            break;
        case ColorSource::Classification:
            legend.title = "Classification";
            addClasses(cloud, style, legend);
            break;
        case ColorSource::Normal:
            legend.title = "Directions of normals";
            legend.rows = {{Rgb8{255, 128, 128}, "along x"},
                           {Rgb8{128, 255, 128}, "along y"},
                           {Rgb8{128, 128, 255}, "up"}};
            break;
        case ColorSource::Curvature:
            legend.title = withUnit("Curvature", unit.empty() ? unit : "1/" + unit);
            addRamp(planned, legend);
            break;
        case ColorSource::Depth:
            legend.title = withUnit("Depth below the viewer", unit);
            addRamp(planned, legend);
            break;
        case ColorSource::Lod:
            legend.title = "Level of detail";
            for (std::size_t level = 0; level < levelCycle; ++level)
                legend.rows.push_back({levelColors()[level], fmt::format("level {}", level)});
            legend.rows.push_back({std::nullopt, "then again"});
            break;
        case ColorSource::Visibility:
            legend.title = "Hidden points";
            addHiddenPoints(planned, legend);
            break;
        case ColorSource::Cloud:
            legend.title = "Clouds";
            addClouds(cloud, legend);
            break;
        case ColorSource::Flat:
            legend.title = "One colour";
            legend.rows.push_back({style.flatColor, hexOf(style.flatColor)});
            break;
        case ColorSource::Column:
            legend.title = capitalized(style.column);
            addRamp(planned, legend);
            if (std::string text = columnText(cloud, style.column); !text.empty())
                legend.rows.push_back({std::nullopt, std::move(text)});
            break;
    }
    if (style.byIntensity) legend.rows.push_back({std::nullopt, "brighter where intensity is"});
    return legend;
}

}  // namespace scancast
