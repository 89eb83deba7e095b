#include "renderer/cloud/import/stream/stream_stations.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/stream_json.hpp"

namespace scancast::point_stream {

namespace {

using nlohmann::json;

tl::unexpected<Error> wrongStation(const std::string& reason) {
    return fail(ErrorCode::Importer, "a station of its point stream is wrong: " + reason);
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
            return wrongStation(quotedText(key) + " is not known of one");
        }
    }
    if (!hasPosition) return wrongStation("it has no position");
    return station;
}

}  // namespace scancast::point_stream
