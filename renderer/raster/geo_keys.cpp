#include "renderer/raster/geo_keys.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/crs_units.hpp"

namespace scancast {
namespace {

// OGC 19-008r4, annex B.
constexpr std::uint16_t modelType = 1024, rasterType = 1025, citation = 1026, geographicType = 2048,
                        projectedType = 3072, projectedCitation = 3073, projectedUnits = 3076,
                        verticalType = 4096, verticalCitation = 4097, verticalUnits = 4099;
constexpr std::uint16_t projected = 1, geographic = 2, pixelIsArea = 1, userDefined = 32767;
/// Of the register's numbers, which end where GeoTIFF's own begin.
constexpr int mostEpsg = 32766;
constexpr std::size_t longestText = 30'000;

/// EPSG's number of a unit of length.
std::optional<std::uint16_t> unitCode(double metres) {
    if (metres == 1) return 9001;
    if (std::abs(metres - 0.3048) < 1e-9) return 9002;
    if (std::abs(metres - 1200.0 / 3937) < 1e-9) return 9003;
    return std::nullopt;
}

/// '|' separates texts in a GeoTIFF, which are ASCII.
std::string asKey(std::string_view text) {
    std::string plain;
    for (const char c : text.substr(0, longestText)) plain += c >= ' ' && c <= '~' && c != '|' ? c : '?';
    return plain;
}

bool isGeographic(const CrsUnits& units, const std::optional<int>& epsg) {
    if (units.kind == CrsUnits::Kind::Geographic) return true;
    // A number alone: that block of the register is geographic systems.
    const int number = epsg.value_or(0);
    return units.kind == CrsUnits::Kind::Unknown && number >= 4000 && number < 5000;
}

double heightMetres(const CrsUnits& units) {
    if (units.verticalMetres > 0) return units.verticalMetres;
    return units.kind == CrsUnits::Kind::Plane ? units.metres : 0;
}

}  // namespace

std::string heightUnit(const CloudFacts& cloud) {
    const CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    if (!units.verticalUnit.empty()) return units.verticalUnit;
    return units.kind == CrsUnits::Kind::Plane ? units.unit : std::string();
}

std::vector<GeoKey> geoKeys(const CloudFacts& cloud) {
    std::vector<GeoKey> keys{{rasterType, pixelIsArea}};
    const auto add = [&](std::uint16_t key, std::variant<std::uint16_t, std::string> value) {
        keys.push_back({key, std::move(value)});
    };
    const auto meaning = crsMeaning(cloud.crsWkt, cloud.crsEpsg);
    if (!meaning) return keys;
    const CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    std::optional<int> epsg = meaning->epsg ? meaning->epsg : cloud.crsEpsg;
    if (epsg && (*epsg < 1 || *epsg > mostEpsg)) epsg.reset();
    const bool flat = !isGeographic(units, epsg);
    const std::string name = crsName(cloud.crsWkt, cloud.crsEpsg);
    const bool isWhole = cloud.crsWkt.size() <= longestText;
    if (!name.empty()) add(citation, asKey(name));
    if (epsg) {
        add(modelType, flat ? projected : geographic);
        add(flat ? projectedType : geographicType, std::uint16_t(*epsg));
    } else if (flat && isWhole && !cloud.crsWkt.empty()) {
        add(modelType, projected);
        add(projectedType, userDefined);
        add(projectedCitation, "ESRI PE String = " + asKey(cloud.crsWkt));
        if (const auto unit = unitCode(units.metres)) add(projectedUnits, *unit);
    }
    if (units.verticalEpsg && *units.verticalEpsg > 0 && *units.verticalEpsg <= mostEpsg)
        add(verticalType, std::uint16_t(*units.verticalEpsg));
    if (!units.verticalName.empty()) add(verticalCitation, asKey(units.verticalName));
    if (const auto unit = unitCode(heightMetres(units))) add(verticalUnits, *unit);
    std::ranges::sort(keys, {}, &GeoKey::key);
    return keys;
}

}  // namespace scancast
