// What GetFeatureInfo answers: a picked point. Pure functions; any thread.
#pragma once

#include <glm/vec2.hpp>
#include <nlohmann/json_fwd.hpp>

#include "server/net/api/http_message.hpp"
#include "server/net/maps/map_request.hpp"

namespace scancast {

/// `picked`: as a pick answers; null: nothing is there. As JSON a GeoJSON FeatureCollection, whose feature is at `place`, in the map's
/// coordinates as it was asked, with the point's own among its properties.
HttpResponse featureResponse(InfoFormat format, const nlohmann::json& picked, const glm::dvec2& place);

}  // namespace scancast
