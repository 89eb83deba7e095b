#include "renderer/cloud/import/crs_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "renderer/cloud/import/wkt.hpp"

namespace scancast {

namespace {

bool isCompound(const WktNode& node) {
    return node.keyword == "COMPD_CS" || node.keyword == "COMPOUNDCRS";
}

/// The grids that most scans are in; x and y of all of them are metres.
std::string zoneName(int epsg) {
    struct Zones {
        int first, last, zone;
        const char* name;
        char side;
    };
    static constexpr Zones zones[] = {{32601, 32660, 1, "WGS 84 / UTM zone ", 'N'},
                                      {32701, 32760, 1, "WGS 84 / UTM zone ", 'S'},
                                      {25828, 25838, 28, "ETRS89 / UTM zone ", 'N'},
                                      {26901, 26923, 1, "NAD83 / UTM zone ", 'N'},
                                      {26701, 26722, 1, "NAD27 / UTM zone ", 'N'}};
    for (const auto& [first, last, zone, name, side] : zones)
        if (epsg >= first && epsg <= last) return name + std::to_string(zone + epsg - first) + side;
    return {};
}

}  // namespace

/// Files spell units in many ways; the factor is the same in all.
std::string unitName(const WktNode& unit) {
    struct Known {
        double factor;
        const char* name;
    };
    static constexpr Known known[] = {{1, "metre"},
                                      {0.3048, "foot"},
                                      {1200.0 / 3937.0, "US survey foot"},
                                      {0.017453292519943295, "degree"},
                                      {0.001, "millimetre"},
                                      {1000, "kilometre"}};
    double factor = 0;
    if (unit.values.size() >= 2)
        std::from_chars(unit.values[1].data(), unit.values[1].data() + unit.values[1].size(), factor);
    for (const auto& [value, name] : known)
        if (std::abs(factor - value) < 1e-8 * value) return name;
    auto word = unit.values.empty() ? std::string() : unit.values[0];
    std::replace(word.begin(), word.end(), '_', ' ');
    return word;
}

const WktNode* horizontalPart(const WktNode& root) {
    const auto* part = &root;
    if (isCompound(root))
        part = root.find({"PROJCS", "GEOGCS", "GEOCCS", "LOCAL_CS", "PROJCRS", "PROJECTEDCRS", "GEOGCRS",
                          "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS", "ENGCRS", "BOUNDCRS"});
    if (part == nullptr || part->keyword != "BOUNDCRS") return part;
    const auto* source = part->find({"SOURCECRS"});
    return source == nullptr || source->nodes.empty() ? nullptr : &source->nodes.front();
}

/// AUTHORITY["EPSG","26910"] or ID["EPSG",26910].
std::optional<int> ownEpsg(const WktNode& node) {
    const auto* id = node.find({"AUTHORITY", "ID"});
    if (id == nullptr || id->values.size() < 2 || id->values[0] != "EPSG") return std::nullopt;
    const auto& text = id->values[1];
    int number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    // As in GeoTIFF keys: 1 to 32766.
    const bool good =
        problem == std::errc() && end == text.data() + text.size() && number > 0 && number < 32767;
    return good ? std::optional(number) : std::nullopt;
}

const WktNode* unitOf(const WktNode& crs) {
    if (const auto* unit = crs.find({"UNIT", "LENGTHUNIT", "ANGLEUNIT"})) return unit;
    // WKT 2 may give it axis by axis.
    const auto* axis = crs.find({"AXIS"});
    return axis == nullptr ? nullptr : axis->find({"UNIT", "LENGTHUNIT", "ANGLEUNIT"});
}

std::string nameOfEpsg(int epsg) {
    if (epsg == 4326) return "WGS 84";
    if (epsg == 3857) return "WGS 84 / Pseudo-Mercator";
    return zoneName(epsg);
}

std::optional<int> epsgOfWkt(std::string_view wkt) {
    const auto root = parseWkt(wkt);
    if (!root) return std::nullopt;
    if (const auto epsg = ownEpsg(*root)) return epsg;
    const auto* part = horizontalPart(*root);
    return part == nullptr ? std::nullopt : ownEpsg(*part);
}

std::string crsName(std::string_view wkt, std::optional<int> epsg) {
    std::string name;
    if (const auto root = parseWkt(wkt); root && !root->values.empty()) name = root->values[0];
    if (!epsg) return name;
    if (name.empty()) name = nameOfEpsg(*epsg);
    const auto number = "EPSG:" + std::to_string(*epsg);
    return name.empty() ? number : name + " (" + number + ")";
}

std::string crsUnit(std::string_view wkt, std::optional<int> epsg) {
    if (const auto root = parseWkt(wkt)) {
        const auto* crs = horizontalPart(*root);
        const auto* unit = crs == nullptr ? nullptr : unitOf(*crs);
        if (unit != nullptr) return unitName(*unit);
    }
    if (!epsg) return {};
    if (*epsg == 4326) return "degree";
    return nameOfEpsg(*epsg).empty() ? std::string() : "metre";
}

}  // namespace scancast
