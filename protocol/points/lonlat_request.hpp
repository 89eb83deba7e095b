// The body of POST /clouds/{id}/lonlat: places in a cloud's coordinates that shall become longitudes and latitudes, or the other way
// round. Pure functions; any thread. Pipeline: client → **request** → server/net/maps → renderer/geo.
#pragma once

#include <glm/vec2.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// As many as a body of 64 KiB has.
inline constexpr std::size_t mostLonLatPoints = 2000;

struct LonLatRequest {
    bool toFile = false;             ///< else to longitude and latitude
    std::vector<glm::dvec2> points;  ///< file coordinates x, y; or longitude, latitude in degrees, WGS 84
    bool operator==(const LonLatRequest&) const = default;
};

/// {"points": [[x, y], …], "to": "lonlat" or "file"}; a third number of a point, its height, has no part in it. Errors: those of
/// parseJson(); InvalidArgument whose field is the JSON path.
Expected<LonLatRequest> parseLonLatRequest(std::string_view text);
nlohmann::json toJson(const LonLatRequest& request);

/// The answer's points; nullopt for those that have no place there. Malformed.
using LonLatPoints = std::vector<std::optional<glm::dvec2>>;
Expected<LonLatPoints> parseLonLatAnswer(const nlohmann::json& answer);
nlohmann::json toJson(const LonLatPoints& points);

}  // namespace scancast
