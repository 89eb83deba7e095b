#include "renderer/cloud/import/crs_units.hpp"

#include <charconv>
#include <cmath>

#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/wkt.hpp"

namespace scancast {

namespace {

double factorIn(const WktNode& unit) {
    double factor = 0;
    if (unit.values.size() >= 2)
        std::from_chars(unit.values[1].data(), unit.values[1].data() + unit.values[1].size(), factor);
    return std::isfinite(factor) && factor > 0 ? factor : 0;
}

CrsUnits::Kind unitKind(const std::optional<CrsMeaning>& meaning, const std::string& unit) {
    using Kind = CrsMeaning::Kind;
    const Kind kind = meaning ? meaning->kind : Kind::Unknown;
    if (kind == Kind::Geographic || unit == "degree") return CrsUnits::Kind::Geographic;
    if (kind == Kind::Geocentric) return CrsUnits::Kind::Geocentric;
    if (kind == Kind::Projected || kind == Kind::Local || !unit.empty()) return CrsUnits::Kind::Plane;
    return CrsUnits::Kind::Unknown;
}

}  // namespace

CrsUnits crsUnits(std::string_view wkt, std::optional<int> epsg) {
    CrsUnits units;
    const auto meaning = crsMeaning(wkt, epsg);
    units.unit = crsUnit(wkt, epsg);
    units.kind = unitKind(meaning, units.unit);
    const auto root = parseWkt(wkt);
    if (units.kind == CrsUnits::Kind::Plane) {
        const auto* crs = root ? horizontalPart(*root) : nullptr;
        const auto* unit = crs == nullptr ? nullptr : unitOf(*crs);
        units.metres = unit != nullptr ? factorIn(*unit) : units.unit == "metre" ? 1 : 0;
    }
    if (!root) return units;
    const auto* vertical = root->find({"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"});
    if (vertical == nullptr) return units;
    if (!vertical->values.empty()) units.verticalName = vertical->values[0];
    units.verticalEpsg = ownEpsg(*vertical);
    if (const auto* unit = unitOf(*vertical)) {
        units.verticalUnit = unitName(*unit);
        units.verticalMetres = factorIn(*unit);
    }
    return units;
}

}  // namespace scancast
