#include "renderer/raster/geo_keys.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/crs_units.hpp"
#include "renderer/geo/geo_reference.hpp"

namespace scancast {
namespace {

// OGC 19-008r4, annex B.
constexpr std::uint16_t modelType = 1024, rasterType = 1025, citation = 1026, geographicType = 2048,
                        geographicCitation = 2049, datum = 2050, primeMeridianType = 2051,
                        angularUnits = 2054, ellipsoidType = 2056, semiMajorAxis = 2057,
                        inverseFlattening = 2059, primeMeridianLongitude = 2061, projectedType = 3072,
                        projectedCitation = 3073, projection = 3074, projectionMethod = 3075,
                        projectedUnits = 3076, projectedUnitSize = 3077, verticalType = 4096,
                        verticalCitation = 4097, verticalUnits = 4099;
constexpr std::uint16_t projected = 1, geographic = 2, pixelIsArea = 1, degree = 9102, userDefined = 32767;

/// How GeoTIFF names what EPSG's register calls a parameter; by either's number.
struct ParameterName {
    int epsg;
    std::uint16_t key;
    enum Kind : std::uint8_t { Degrees, Length, Ratio } kind;
};
constexpr ParameterName natural[] = {{8801, 3081, ParameterName::Degrees},
                                     {8802, 3080, ParameterName::Degrees},
                                     {8805, 3092, ParameterName::Ratio},
                                     {8806, 3082, ParameterName::Length},
                                     {8807, 3083, ParameterName::Length}};
constexpr ParameterName conic[] = {{8821, 3085, ParameterName::Degrees}, {8822, 3084, ParameterName::Degrees},
                                   {8823, 3078, ParameterName::Degrees}, {8824, 3079, ParameterName::Degrees},
                                   {8826, 3086, ParameterName::Length},  {8827, 3087, ParameterName::Length}};
constexpr ParameterName albers[] = {
    {8821, 3081, ParameterName::Degrees}, {8822, 3080, ParameterName::Degrees},
    {8823, 3078, ParameterName::Degrees}, {8824, 3079, ParameterName::Degrees},
    {8826, 3082, ParameterName::Length},  {8827, 3083, ParameterName::Length}};
constexpr ParameterName centred[] = {{8801, 3089, ParameterName::Degrees},
                                     {8802, 3088, ParameterName::Degrees},
                                     {8806, 3082, ParameterName::Length},
                                     {8807, 3083, ParameterName::Length}};
constexpr ParameterName polar[] = {{8801, 3081, ParameterName::Degrees},
                                   {8802, 3095, ParameterName::Degrees},
                                   {8805, 3092, ParameterName::Ratio},
                                   {8806, 3082, ParameterName::Length},
                                   {8807, 3083, ParameterName::Length}};
struct ProjectionName {
    int epsg;
    std::uint16_t method;
    std::span<const ParameterName> parameters;
};
const ProjectionName projections[] = {
    {9807, 1, natural},   // Transverse Mercator
    {9804, 7, natural},   // Mercator (variant A)
    {9802, 8, conic},     // Lambert Conic Conformal (2SP)
    {9801, 9, natural},   // Lambert Conic Conformal (1SP)
    {9820, 10, centred},  // Lambert Azimuthal Equal Area
    {9822, 11, albers},   // Albers Equal Area
    {9810, 15, polar},    // Polar Stereographic (variant A)
    {9809, 16, natural},  // Oblique Stereographic
};

/// Of the register's numbers, which end where GeoTIFF's own begin.
constexpr int mostEpsg = 32766;
constexpr std::size_t longestText = 1000;

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

using Value = std::variant<std::uint16_t, double, std::string>;

class Keys {
  public:
    void add(std::uint16_t key, Value value) { all_.push_back({key, std::move(value)}); }
    void addText(std::uint16_t key, std::string_view text) {
        if (!text.empty()) add(key, asKey(text));
    }
    void addUnit(std::uint16_t key, double metres) {
        if (const auto unit = unitCode(metres)) add(key, *unit);
    }
    std::vector<GeoKey> sorted() {
        std::ranges::sort(all_, {}, &GeoKey::key);
        return std::move(all_);
    }

  private:
    std::vector<GeoKey> all_{};
};

void addBase(const CrsParts::Base& base, Keys& keys) {
    if (base.epsg && *base.epsg <= mostEpsg) return keys.add(geographicType, std::uint16_t(*base.epsg));
    keys.add(geographicType, userDefined);
    keys.addText(geographicCitation, base.name);
    keys.add(datum, userDefined);
    keys.add(angularUnits, degree);
    keys.add(ellipsoidType, userDefined);
    keys.add(semiMajorAxis, base.semiMajor);
    keys.add(inverseFlattening, base.inverseFlattening);
    if (base.primeMeridian == 0) return;
    keys.add(primeMeridianType, userDefined);
    keys.add(primeMeridianLongitude, base.primeMeridian);
}

/// Nothing where GeoTIFF has no words for the projection.
void addProjected(const CrsParts& parts, const FileCrs& file, Keys& keys) {
    const auto* const named = std::ranges::find(projections, parts.method, &ProjectionName::epsg);
    if (named == std::end(projections)) return;
    keys.add(modelType, projected);
    keys.add(projectedType, userDefined);
    keys.addText(projectedCitation, file.name);
    keys.add(projection, userDefined);
    keys.add(projectionMethod, named->method);
    const auto unit = unitCode(file.metresPerUnit);
    keys.add(projectedUnits, unit.value_or(userDefined));
    if (!unit) keys.add(projectedUnitSize, file.metresPerUnit);
    for (const ParameterName& parameter : named->parameters) {
        const auto given = parts.parameters.find(parameter.epsg);
        if (given == parts.parameters.end()) continue;
        keys.add(parameter.key, parameter.kind == ParameterName::Length ? given->second / file.metresPerUnit
                                                                        : given->second);
    }
    addBase(parts.base, keys);
}

void addNumber(int epsg, bool flat, Keys& keys) {
    keys.add(modelType, flat ? projected : geographic);
    keys.add(flat ? projectedType : geographicType, std::uint16_t(epsg));
}

/// Of a system whose text names no number.
void addByMeaning(const CloudFacts& cloud, Keys& keys) {
    const auto reference = GeoReference::create(cloud);
    if (!reference) return;
    const FileCrs& file = reference->file();
    if (file.epsg && *file.epsg <= mostEpsg) return addNumber(*file.epsg, !file.degrees, keys);
    const auto parts = reference->parts();
    if (!parts) return;
    if (!file.degrees) return addProjected(*parts, file, keys);
    keys.add(modelType, geographic);
    addBase(parts->base, keys);
}

}  // namespace

std::string heightUnit(const CloudFacts& cloud) {
    const CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    if (!units.verticalUnit.empty()) return units.verticalUnit;
    return units.kind == CrsUnits::Kind::Plane ? units.unit : std::string();
}

std::vector<GeoKey> geoKeys(const CloudFacts& cloud) {
    Keys keys;
    keys.add(rasterType, pixelIsArea);
    const auto meaning = crsMeaning(cloud.crsWkt, cloud.crsEpsg);
    if (!meaning) return keys.sorted();
    const CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    std::optional<int> epsg = meaning->epsg ? meaning->epsg : cloud.crsEpsg;
    if (epsg && (*epsg < 1 || *epsg > mostEpsg)) epsg.reset();
    keys.addText(citation, crsName(cloud.crsWkt, cloud.crsEpsg));
    if (epsg)
        addNumber(*epsg, !isGeographic(units, epsg), keys);
    else
        addByMeaning(cloud, keys);
    if (units.verticalEpsg && *units.verticalEpsg > 0 && *units.verticalEpsg <= mostEpsg)
        keys.add(verticalType, std::uint16_t(*units.verticalEpsg));
    keys.addText(verticalCitation, units.verticalName);
    keys.addUnit(verticalUnits, heightMetres(units));
    return keys.sorted();
}

}  // namespace scancast
