#include "protocol/points/points_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/json_fields.hpp"
#include "protocol/nearest_name.hpp"
#include "protocol/view/view_values.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

constexpr std::array<std::string_view, 4> regionWords{"clip", "clips", "classes", "filter"};

const ViewWord* regionWord(std::string_view name) {
    for (const ViewWord& word : viewWords())
        if (word.word == name) return &word;
    return nullptr;
}

void take(const View& view, std::string_view word, PointsRegion& region) {
    if (word == "clip") region.clip = view.style.clip;
    if (word == "clips") region.clips = view.style.clips;
    if (word == "filter") region.filter = view.style.filter;
    if (word != "classes") return;
    region.classes.reset();
    if (!view.style.classes) return;
    region.classes.emplace();
    for (const std::uint8_t c : *view.style.classes) region.classes->set(c);
}

Expected<void> checkHeights(const std::array<double, 2>& z) {
    if (std::isfinite(z[0]) && std::isfinite(z[1]) && z[0] <= z[1]) return {};
    return fail(ErrorCode::InvalidArgument, "z: must be the lowest and the highest height, in that order",
                "z");
}

std::optional<glm::dvec2> placeOf(const nlohmann::json& value) {
    if (!value.is_array() || value.size() != 2 || !value[0].is_number() || !value[1].is_number())
        return std::nullopt;
    const glm::dvec2 place(value[0].get<double>(), value[1].get<double>());
    if (!isPlanPlace(place)) return std::nullopt;
    return place;
}

}  // namespace

bool isPlanPlace(const glm::dvec2& place) {
    constexpr double farthest = 1e12;  // as measurements have it; NaN is not below it
    return std::abs(place.x) <= farthest && std::abs(place.y) <= farthest;
}

Expected<void> checkPolygon(const PlanPolygon& polygon) {
    if (!std::ranges::all_of(polygon, isPlanPlace))
        return fail(ErrorCode::InvalidArgument, "polygon: must have numbers up to 1e12", "polygon");
    if (polygon.size() >= 3 && polygon.size() <= mostPolygonCorners) return {};
    return fail(ErrorCode::InvalidArgument,
                "polygon: must have 3 to " + std::to_string(mostPolygonCorners) + " corners, and has " +
                    std::to_string(polygon.size()),
                "polygon");
}

Expected<std::vector<glm::dvec2>> parsePlanPlaces(std::string_view text, std::string_view field) {
    std::vector<glm::dvec2> places;
    while (!text.empty()) {
        const auto end = text.find(';');
        std::array<double, 2> numbers{};
        if (auto ok = values::parseNumbers(text.substr(0, end), numbers); !ok)
            return fail(ErrorCode::InvalidArgument,
                        std::string(field) + ": " + quoteText(text.substr(0, end)) +
                            " is no place in plan; expected X,Y;X,Y;...",
                        std::string(field));
        places.emplace_back(numbers[0], numbers[1]);
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
    return places;
}

Expected<std::array<double, 2>> parseHeights(std::string_view text) {
    std::array<double, 2> z{};
    if (auto ok = values::parseNumbers(text, z); !ok)
        return fail(ErrorCode::InvalidArgument, "z: " + ok.error(), "z");
    if (auto ok = checkHeights(z); !ok) return passOn(ok);
    return z;
}

Expected<void> applyRegionWord(PointsRegion& region, std::string_view word, std::string_view text) {
    View view;
    if (auto ok = applyWord(view, word, text); !ok) return ok;
    if (auto ok = checkWord(word, text); !ok) return ok;
    take(view, word, region);
    return {};
}

bool readPlanPlaces(FieldReader& fields, std::string_view key, std::size_t least, std::size_t most,
                    std::vector<glm::dvec2>& out) {
    const auto* field = fields.findValue(key);
    if (field == nullptr) return false;
    if (!field->is_array() || field->size() < least || field->size() > most) {
        fields.error(key, "expected an array of " + std::to_string(least) + " to " + std::to_string(most) +
                              " places [x, y]");
        return false;
    }
    std::vector<glm::dvec2> places;
    for (const auto& value : *field) {
        const auto place = placeOf(value);
        if (!place) {
            fields.error(key, "each place must be two numbers: [x, y]");
            return false;
        }
        places.push_back(*place);
    }
    out = std::move(places);
    return true;
}

void readRegion(FieldReader& fields, PointsRegion& region) {
    View view;
    for (const std::string_view name : regionWords) {
        const ViewWord* word = regionWord(name);
        if (word != nullptr && word->value.read(view, fields, name)) take(view, name, region);
    }
    if (auto sound = validate(view); !sound) {
        Error error = sound.error();
        error.field = fields.path(error.field);
        return fields.error(error);
    }
    PlanPolygon polygon;
    if (readPlanPlaces(fields, "polygon", 3, mostPolygonCorners, polygon))
        region.polygon = std::move(polygon);
    std::array<double, 2> z{};
    if (fields.findValue("z") != nullptr && fields.numbers("z", z)) {
        if (!checkHeights(z))
            return fields.error("z", "must be the lowest and the highest height, in that order");
        region.z = z;
    }
}

nlohmann::json planPlacesJson(const std::vector<glm::dvec2>& places) {
    nlohmann::json list = nlohmann::json::array();
    for (const glm::dvec2& place : places) list.push_back({place.x, place.y});
    return list;
}

nlohmann::json toJson(const PointsRegion& region) {
    nlohmann::json object = nlohmann::json::object();
    View view;
    view.style.clip = region.clip;
    view.style.clips = region.clips;
    view.style.filter = region.filter;
    if (region.classes) {
        view.style.classes.emplace();
        for (unsigned c = 0; c < region.classes->size(); ++c)
            if (region.classes->test(c)) view.style.classes->push_back(std::uint8_t(c));
    }
    for (const std::string_view name : regionWords)
        if (const ViewWord* word = regionWord(name))
            if (auto value = word->value.print(view); !value.is_null())
                object[std::string(name)] = std::move(value);
    if (region.polygon) object["polygon"] = planPlacesJson(*region.polygon);
    if (region.z) object["z"] = *region.z;
    return object;
}

}  // namespace scancast
