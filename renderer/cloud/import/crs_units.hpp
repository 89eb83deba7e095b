// What the numbers of a coordinate reference system are in, so that lengths can be told: unit of x and y, of heights, and whether
// there are lengths at all (degrees are none). Pure functions on text from outside.
// Pipeline: scan header → **units** → pick, measure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scancast {

struct CrsUnits {
    enum class Kind : unsigned char {
        Unknown,     ///< nothing is said, or nothing that is understood: x, y and z are taken for one unit
        Plane,       ///< projected, or local: x and y are lengths
        Geographic,  ///< x and y are degrees
        Geocentric,  ///< lengths from the middle of the earth: z is not up
    };
    Kind kind = Kind::Unknown;
    std::string unit;           ///< of x and y, as crsUnit(); empty = unknown
    double metres = 0;          ///< that one of it is; 0: unknown, or no length
    std::string verticalName;   ///< of what heights count from, as the file calls it; empty = not said
    std::string verticalUnit;   ///< empty = not said
    double verticalMetres = 0;  ///< 0 = not said
    std::optional<int> verticalEpsg;

    /// Units of x and y that one of z is; 1 where either is not known.
    double heightScale() const { return metres > 0 && verticalMetres > 0 ? verticalMetres / metres : 1; }
};

CrsUnits crsUnits(std::string_view wkt, std::optional<int> epsg);

}  // namespace scancast
