// What a coordinate reference system is called, out of its WKT (1 and 2), for people. Pure functions on text
// from outside: any text at all is allowed, and what cannot be understood gives nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scancast {

struct WktNode;

/// The number that the whole CRS has in EPSG's register, by its own AUTHORITY or ID; of a compound CRS
/// without one, that of its horizontal part. Not that of a part such as the spheroid.
std::optional<int> epsgOfWkt(std::string_view wkt);

/// "NAD83 / UTM zone 10N (EPSG:26910)", as far as it is known: without WKT the name of a few common ones,
/// else the number alone; empty = nothing is known.
std::string crsName(std::string_view wkt, std::optional<int> epsg);

/// The unit of x and y: "metre", "foot", "US survey foot", "degree", or the file's own word; empty = unknown.
std::string crsUnit(std::string_view wkt, std::optional<int> epsg);

/// The part of a CRS that says what x and y are: of a compound or bound one, a node within it; nullptr = it has none.
const WktNode* horizontalPart(const WktNode& root);
/// A node's own number in EPSG's register, 1 to 32766.
std::optional<int> ownEpsg(const WktNode& node);
/// The unit of a CRS's axes: its name, and the factor to metres or radians; nullptr = it gives none.
const WktNode* unitOf(const WktNode& crs);
/// What a unit is called: by its factor, where that is a common one, else by the file's own word.
std::string unitName(const WktNode& unit);
/// What EPSG calls a few common ones; empty = not one of them.
std::string nameOfEpsg(int epsg);

}  // namespace scancast
