#include "renderer/cloud/import/las/las_crs.hpp"

#include <algorithm>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

constexpr int wktRecord = 2112;
constexpr int geoKeyRecord = 34735;
constexpr std::uint16_t projectedKey = 3072;
constexpr std::uint16_t geographicKey = 2048;
constexpr std::uint16_t userDefined = 32767;

/// Value of a GeoTIFF key that stands in the directory itself.
std::optional<int> geoKey(std::span<const std::byte> directory, std::uint16_t wanted) {
    // Four numbers of head (the fourth is the number of keys), then four numbers a key: id, where, count,
    // value.
    if (directory.size() < 8) return std::nullopt;
    const std::size_t present = directory.size() / 8 - 1;
    const auto keys = std::min<std::size_t>(loadLe<std::uint16_t>(directory.data() + 6), present);
    for (std::size_t i = 1; i <= keys; ++i) {
        const auto* key = directory.data() + 8 * i;
        const auto value = loadLe<std::uint16_t>(key + 6);
        const bool here = loadLe<std::uint16_t>(key + 2) == 0;
        if (loadLe<std::uint16_t>(key) == wanted && here && value != 0 && value != userDefined) return value;
    }
    return std::nullopt;
}

}  // namespace

void readProjectionRecord(int recordId, std::span<const std::byte> content, LasCrs& crs) {
    if (recordId == wktRecord && crs.wkt.empty() && content.size() <= longestCrsWkt)
        crs.wkt =
            printableText({reinterpret_cast<const char*>(content.data()), content.size()}, longestCrsWkt);
    if (recordId == geoKeyRecord && !crs.epsg) {
        crs.epsg = geoKey(content, projectedKey);
        if (!crs.epsg) crs.epsg = geoKey(content, geographicKey);
    }
}

}  // namespace scancast
