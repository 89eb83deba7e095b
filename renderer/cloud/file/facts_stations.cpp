#include "renderer/cloud/file/facts_stations.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace scancast {

namespace {

using Json = nlohmann::json;

Json stationJson(const Station& station) {
    Json json{{"name", station.name}, {"position", vectorJson(station.position)}, {"points", station.points}};
    if (station.forwards) json["forwards"] = vectorJson(*station.forwards);
    return json;
}

Json photoJson(const Photo& photo, const BlockPlace& place) {
    Json json{{"name", photo.name},     {"format", name(photo.format)},
              {"width", photo.width},   {"height", photo.height},
              {"bytes", place.bytes},   {"projection", name(photo.projection)},
              {"offset", place.offset}, {"checksum", place.checksum}};
    if (photo.angles[0] > 0 || photo.angles[1] > 0) json["angles"] = photo.angles;
    if (photo.station) json["station"] = *photo.station;
    if (photo.pose)
        json["pose"] = {{"position", vectorJson(photo.pose->position)},
                        {"forwards", vectorJson(photo.pose->forwards)},
                        {"up", vectorJson(photo.pose->up)}};
    return json;
}

void takeStation(FactsFields fields, Station& into) {
    fields.text("name", into.name, longestStationName);
    fields.vector("position", into.position);
    fields.whole("points", into.points);
    if (fields.has("forwards")) fields.unitVector("forwards", into.forwards.emplace());
}

void takePose(FactsFields fields, Photo::Pose& into) {
    fields.vector("position", into.position);
    fields.unitVector("forwards", into.forwards);
    fields.unitVector("up", into.up);
    if (!(std::abs(glm::dot(into.forwards, into.up)) <= 1e-5))
        fields.blame("up", "is at no right angle to \"forwards\"");
}

template <class T>
void takeName(FactsFields& fields, const char* key, std::optional<T> (*find)(std::string_view), T& into) {
    std::string text;
    fields.text(key, text);
    const auto found = find(text);
    found ? void(into = *found) : fields.blame(key, "is none that there is");
}

void takePhoto(FactsFields fields, std::size_t stations, Photo& into, BlockPlace& place) {
    fields.text("name", into.name, longestPhotoName);
    takeName(fields, "format", photoFormatOf, into.format);
    takeName(fields, "projection", photoProjectionOf, into.projection);
    fields.whole("width", into.width);
    fields.whole("height", into.height);
    fields.whole("bytes", place.bytes, largestPhoto);
    fields.whole("offset", place.offset);
    fields.whole("checksum", place.checksum);
    into.bytes = place.bytes;
    if (into.bytes == 0) fields.blame("bytes", "is 0");
    if (fields.has("angles")) {
        if (const auto* angles = fields.list("angles", into.angles.size()))
            for (std::size_t i = 0; i < into.angles.size(); ++i) {
                fields.number((*angles)[i], "angles", into.angles[i]);
                if (!(into.angles[i] >= 0 && into.angles[i] <= 2 * std::numbers::pi + 1e-6))
                    fields.blame("angles", "are no angles");
            }
    }
    if (fields.has("station")) {
        fields.whole("station", into.station.emplace());
        if (*into.station >= stations) fields.blame("station", "is none that there is");
    }
    if (fields.has("pose"))
        takePose({*fields.find("pose"), fields.member("pose"), fields.fault()}, into.pose.emplace());
}

}  // namespace

void addStations(const CloudFacts& facts, std::span<const BlockPlace> photos, Json& json) {
    for (const Station& station : facts.stations) json["stations"].push_back(stationJson(station));
    for (std::size_t i = 0; i < photos.size(); ++i)
        json["photos"].push_back(photoJson(facts.photos[i], photos[i]));
}

void takeStations(FactsFields& fields, CloudFacts& facts) {
    if (!fields.has("stations")) return;
    if (const Json* stations = fields.list("stations", FactsFields::noSize, mostStations))
        for (const Json& station : *stations)
            takeStation({station, fields.member("stations"), fields.fault()}, facts.stations.emplace_back());
}

void takePhotos(FactsFields& fields, CloudFacts& facts, std::vector<BlockPlace>& places) {
    if (!fields.has("photos")) return;
    if (const Json* photos = fields.list("photos", FactsFields::noSize, mostPhotos))
        for (const Json& photo : *photos)
            takePhoto({photo, fields.member("photos"), fields.fault()}, facts.stations.size(),
                      facts.photos.emplace_back(), places.emplace_back());
}

}  // namespace scancast
