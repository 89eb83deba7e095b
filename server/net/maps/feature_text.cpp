#include "server/net/maps/feature_text.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "server/net/maps/xml_text.hpp"

namespace scancast {
namespace {

using nlohmann::json;

/// One list of names and values: what GIS programs show as a table.
json flatValues(const json& picked) {
    json values = json::object();
    const auto& place = picked["position"];
    values["x"] = place[0];
    values["y"] = place[1];
    values["z"] = place[2];
    values["exact"] = picked["exact"];
    // Of several clouds: whose point it is, and how far that was moved to where it is seen.
    if (picked.contains("cloud")) values["cloud"] = picked["cloud"];
    if (picked.contains("shift"))
        for (std::size_t axis = 0; axis < 3; ++axis)
            values[std::array{"shiftX", "shiftY", "shiftZ"}[axis]] = picked["shift"][axis];
    for (const char* name : {"intensity", "classification", "className", "radius"})
        if (picked.contains(name)) values[name] = picked[name];
    if (picked.contains("rgb")) {
        values["red"] = picked["rgb"][0];
        values["green"] = picked["rgb"][1];
        values["blue"] = picked["rgb"][2];
    }
    for (const auto& [name, value] : picked["attributes"].items())
        if (!values.contains(name)) values[name] = value;
    return values;
}

std::string shownValue(const json& value) {
    return value.is_string() ? value.get<std::string>() : printJson(value);
}

}  // namespace

HttpResponse featureResponse(InfoFormat format, const json& picked, const glm::dvec2& place) {
    const json values = picked.is_null() ? json::object() : flatValues(picked);
    HttpResponse response;
    std::string type(infoFormatNames[std::size_t(format)]);
    switch (format) {
        case InfoFormat::Json:
        case InfoFormat::GeoJson: {
            json features = json::array();
            if (!picked.is_null()) {
                features.push_back({{"type", "Feature"},
                                    {"id", "point"},
                                    {"geometry", {{"type", "Point"}, {"coordinates", {place.x, place.y}}}},
                                    {"properties", values}});
            }
            response.text = printJson({{"type", "FeatureCollection"}, {"features", std::move(features)}});
            break;
        }
        case InfoFormat::Text:
            for (const auto& [name, value] : values.items())
                response.text += name + " = " + shownValue(value) + "\n";
            if (picked.is_null()) response.text = "no point\n";
            type += "; charset=utf-8";
            break;
        case InfoFormat::Html:
            response.text =
                "<!DOCTYPE html>\n<html><head><meta "
                "charset=\"utf-8\"><title>point</title></head><body>\n<table>\n";
            for (const auto& [name, value] : values.items())
                response.text +=
                    "<tr><th>" + xmlText(name) + "</th><td>" + xmlText(shownValue(value)) + "</td></tr>\n";
            response.text += "</table>\n</body></html>\n";
            type += "; charset=utf-8";
            break;
    }
    response.set("Content-Type", std::move(type)).set("Cache-Control", "no-store");
    return response;
}

}  // namespace scancast
