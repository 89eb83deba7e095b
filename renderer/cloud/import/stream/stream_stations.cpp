#include "renderer/cloud/import/stream/stream_stations.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::point_stream {

namespace {

using nlohmann::json;

tl::unexpected<Error> wrongStation(const std::string& reason) {
    return fail(ErrorCode::Importer, "a station of its point stream is wrong: " + reason);
}

json numbers(const glm::dvec3& v) {
    return json::array({v.x, v.y, v.z});
}

/// False where it is not three finite numbers.
bool takeVector(const json& list, glm::dvec3& into) {
    if (!list.is_array() || list.size() != 3) return false;
    for (int a = 0; a < 3; ++a) {
        const json& value = list[std::size_t(a)];
        if (!value.is_number()) return false;
        into[a] = value.get<double>();
        if (!std::isfinite(into[a])) return false;
    }
    return true;
}

}  // namespace

std::string encodeStation(const Station& station) {
    json object{{"name", printableText(station.name, longestStationName)},
                {"position", numbers(station.position)}};
    if (station.forwards) object["forwards"] = numbers(*station.forwards);
    return object.dump();
}

Expected<Station> decodeStation(std::string_view text) {
    const auto object = json::parse(text, nullptr, false);
    if (!object.is_object()) return wrongStation("it is no JSON object");
    Station station;
    bool hasPosition = false;
    for (const auto& [key, value] : object.items()) {
        if (key == "name") {
            if (!value.is_string()) return wrongStation("its name is no text");
            station.name = printableText(value.get_ref<const std::string&>(), longestStationName);
        } else if (key == "position") {
            hasPosition = takeVector(value, station.position);
            if (!hasPosition) return wrongStation("its position is not three numbers");
        } else if (key == "forwards") {
            glm::dvec3 forwards;
            if (!takeVector(value, forwards)) return wrongStation("its forwards is not three numbers");
            station.forwards = unitVector(forwards);
            if (!station.forwards || std::abs(glm::length(forwards) - 1) > 1e-3)
                return wrongStation("its forwards is no unit vector");
        } else {
            return wrongStation("\"" + printableText(key, longestStationName) + "\" is not known of one");
        }
    }
    if (!hasPosition) return wrongStation("it has no position");
    return station;
}

}  // namespace scancast::point_stream
