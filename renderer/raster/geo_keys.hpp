// Where a raster lies on earth, in GeoTIFF's words (OGC 19-008r4, GeoTIFF 1.1): which CRS, by its number where that is known or PROJ finds
// it by what the scan's text says, else by what it is made of. Any thread; a tenth of a second, where PROJ is asked.
// Pipeline: cloud's facts → **keys** → TIFF.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct GeoKey {
    std::uint16_t key = 0;
    std::variant<std::uint16_t, double, std::string> value{};
    bool operator==(const GeoKey&) const = default;
};

/// Always that a cell's value holds for its area; the rest as far as the cloud says it. In ascending order. A CRS without a number is
/// its ellipsoid, its projection and that one's parameters. What has no words in GeoTIFF - rarer projections - is named, no more.
std::vector<GeoKey> geoKeys(const CloudFacts& cloud);

/// What heights are in: "metre"; empty where nothing is said.
std::string heightUnit(const CloudFacts& cloud);

}  // namespace scancast
