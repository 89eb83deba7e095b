#include "protocol/points/points_request.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

constexpr std::array<std::string_view, 5> colorWords{"color", "exposure", "colormap", "range", "background"};

const ViewWord* viewWord(std::string_view name) {
    const auto words = viewWords();
    const auto found = std::ranges::find_if(words, [&](const ViewWord& word) { return word.word == name; });
    return found == words.end() ? nullptr : &*found;
}

void readRegionOf(FieldReader& parent, PointsRegion& region) {
    const auto* object = parent.findValue("region");
    if (object == nullptr) return;
    FieldReader fields(*object, parent.path("region"));
    readRegion(fields, region);
    if (auto ok = fields.finishStrict(); !ok) parent.error(ok.error());
}

void readPicture(FieldReader& parent, ProfilePicture& picture) {
    const auto* object = parent.findValue("picture");
    if (object == nullptr) return;
    FieldReader fields(*object, parent.path("picture"));
    fields.integer("width", picture.width, 1, mostProfileSide);
    fields.integer("height", picture.height, 1, mostProfileSide);
    fields.integer("pointSize", picture.pointSize, 1, mostProfilePointSize);
    if (fields.number("exaggeration", picture.exaggeration) && picture.exaggeration &&
        !(*picture.exaggeration >= 1e-3 && *picture.exaggeration <= 1e3))
        fields.error("exaggeration", "must lie between 0.001 and 1000");
    View view;
    view.style = picture.style;
    for (const std::string_view name : colorWords) {
        const ViewWord* word = viewWord(name);
        if (word == nullptr || !word->value.read(view, fields, name) || !word->value.check) continue;
        if (auto ok = word->value.check(view, fields.path(name)); !ok) fields.error(ok.error());
    }
    picture.style = view.style;
    if (auto ok = fields.finishStrict(); !ok) parent.error(ok.error());
}

/// Whether a format of points was named; "png" is none, and `picture` says so.
bool readFormat(FieldReader& fields, PointsFormat& format, bool* picture) {
    std::string text;
    if (fields.findValue("format") == nullptr || !fields.text("format", text)) return false;
    if (picture != nullptr) *picture = text == "png";
    if (picture != nullptr && *picture) return false;
    const auto known = pointsFormatOf(text);
    if (known)
        format = *known;
    else
        fields.error("format", picture != nullptr
                                   ? "must be las, ply, csv, txt or png"
                                   : "must be las, ply, csv or txt; LAZ and COPC are made of LAS "
                                     "(pdal translate out.las out.laz)");
    return known.has_value();
}

}  // namespace

std::optional<PointsFormat> pointsFormatOf(std::string_view name) {
    const auto found = std::ranges::find(pointsFormatNames, name);
    if (found == pointsFormatNames.end()) return std::nullopt;
    return PointsFormat(found - pointsFormatNames.begin());
}

std::string_view mediaType(PointsFormat format) {
    switch (format) {
        case PointsFormat::Las:
            return "application/vnd.las";
        case PointsFormat::Ply:
            return "application/octet-stream";
        case PointsFormat::Csv:
            return "text/csv; charset=utf-8";
        case PointsFormat::Text:
            break;
    }
    return "text/plain; charset=utf-8";
}

Expected<void> checkLine(const std::vector<glm::dvec2>& line, double width) {
    const auto wrong = [](std::string_view field, const std::string& what) {
        return fail(ErrorCode::InvalidArgument, std::string(field) + ": " + what, std::string(field));
    };
    if (line.size() < 2 || line.size() > mostLineCorners)
        return wrong("line", "must have 2 to " + std::to_string(mostLineCorners) + " corners, and has " +
                                 std::to_string(line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (!isPlanPlace(line[i])) return wrong("line", "must have numbers up to 1e12");
        if (i == 0) continue;
        const double length = std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
        constexpr double samePlace = 1e-9;
        if (!(length > samePlace))
            return wrong("line",
                         "corner " + std::to_string(i + 1) + " is the same place as the one before it");
    }
    if (!(width > 0) || !(width <= 1e12)) return wrong("width", "must be above 0, up to 1e12");
    return {};
}

Expected<PointsRequest> parsePointsRequest(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    PointsRequest request;
    FieldReader fields(*value);
    readFormat(fields, request.format, nullptr);
    readRegionOf(fields, request.region);
    fields.flag("normals", request.estimatedNormals);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return request;
}

Expected<ProfileRequest> parseProfileRequest(std::string_view text, bool picture) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    ProfileRequest request;
    FieldReader fields(*value);
    if (fields.require("line") != nullptr) readPlanPlaces(fields, "line", 2, mostLineCorners, request.line);
    fields.number("width", request.width);
    PointsFormat format = PointsFormat::Csv;
    bool png = false;
    const bool named = readFormat(fields, format, &png);
    readRegionOf(fields, request.region);
    fields.flag("normals", request.estimatedNormals);
    readPicture(fields, request.picture);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    if (auto ok = checkLine(request.line, request.width); !ok) return passOn(ok);
    request.format = format;
    if (png || (picture && !named)) request.format.reset();
    return request;
}

nlohmann::json toJson(const PointsRequest& request) {
    nlohmann::json object{{"format", name(request.format)}};
    if (!request.region.isEverything()) object["region"] = toJson(request.region);
    if (request.estimatedNormals) object["normals"] = true;
    return object;
}

nlohmann::json toJson(const ProfileRequest& request) {
    nlohmann::json object{{"line", planPlacesJson(request.line)},
                          {"width", request.width},
                          {"format", request.format ? name(*request.format) : std::string_view("png")}};
    if (!request.region.isEverything()) object["region"] = toJson(request.region);
    if (request.estimatedNormals) object["normals"] = true;
    if (request.format) return object;
    const ProfilePicture& picture = request.picture;
    nlohmann::json drawn{{"width", picture.width}};
    if (picture.pointSize) drawn["pointSize"] = *picture.pointSize;
    if (picture.height) drawn["height"] = *picture.height;
    if (picture.exaggeration) drawn["exaggeration"] = *picture.exaggeration;
    View view;
    view.style = picture.style;
    for (const std::string_view word : colorWords)
        if (const ViewWord* known = viewWord(word))
            if (auto value = known->value.print(view); !value.is_null())
                drawn[std::string(word)] = std::move(value);
    object["picture"] = std::move(drawn);
    return object;
}

}  // namespace scancast
