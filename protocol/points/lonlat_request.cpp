#include "protocol/points/lonlat_request.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr double farthestPlace = 1e12;

std::optional<glm::dvec2> knownPlaceOf(const json& value) {
    if (!value.is_array() || value.size() < 2 || value.size() > 3) return std::nullopt;
    for (const json& number : value)
        if (!number.is_number() || !(std::abs(number.get<double>()) <= farthestPlace)) return std::nullopt;
    return glm::dvec2(value[0].get<double>(), value[1].get<double>());
}

}  // namespace

Expected<LonLatRequest> parseLonLatRequest(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    LonLatRequest request;
    FieldReader fields(*value);
    std::string to;
    if (fields.text("to", to)) {
        request.toFile = to == "file";
        if (!request.toFile && to != "lonlat") fields.error("to", "must be lonlat or file");
    }
    const json* const list = fields.require("points");
    if (list != nullptr && (!list->is_array() || list->empty() || list->size() > mostLonLatPoints))
        fields.error("points", "must be a list of 1 to " + std::to_string(mostLonLatPoints) + " places");
    if (list == nullptr || fields.failed()) {
        auto ok = fields.finishStrict();
        if (!ok) return passOn(ok);
        return request;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        const auto place = knownPlaceOf((*list)[i]);
        if (!place) {
            std::string path = "points[";
            path.append(std::to_string(i)).append("]");
            fields.error(path, "must be two numbers, a place in plan view, or three with a height");
            break;
        }
        request.points.push_back(*place);
    }
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return request;
}

json toJson(const LonLatRequest& request) {
    json points = json::array();
    for (const glm::dvec2& place : request.points) points.push_back({place.x, place.y});
    return {{"to", request.toFile ? "file" : "lonlat"}, {"points", std::move(points)}};
}

Expected<LonLatPoints> parseLonLatAnswer(const json& answer) {
    const auto list = answer.is_object() ? answer.find("points") : answer.end();
    if (!answer.is_object() || list == answer.end() || !list->is_array())
        return fail(ErrorCode::Malformed, "The answer has no list of points.");
    LonLatPoints points;
    for (const json& value : *list) {
        const auto place = knownPlaceOf(value);
        if (!place && !value.is_null())
            return fail(ErrorCode::Malformed, "The answer has a point that is no place.");
        points.push_back(place);
    }
    return points;
}

json toJson(const LonLatPoints& points) {
    json list = json::array();
    for (const auto& place : points) list.push_back(place ? json{place->x, place->y} : json());
    return list;
}

}  // namespace scancast
