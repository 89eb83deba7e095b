#include "protocol/view_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/nearest_name.hpp"
#include "protocol/view_values.hpp"

namespace scancast {
namespace {

using nlohmann::json;

/// Reads a string field by one of the functions in view_values.
template <class Parse, class Use>
void word(FieldReader& fields, std::string_view key, Parse parse, Use use) {
    std::string text;
    if (!fields.text(key, text)) return;
    auto parsed = parse(text);
    if (parsed)
        use(*parsed);
    else
        fields.error(key, parsed.error());
}

void readMatrix(FieldReader& fields, bool lookAtGiven, Camera& camera) {
    const auto* matrix = fields.find("viewMatrix");
    if (matrix && !matrix->is_null()) {
        std::array<double, 16> values{};
        if (fields.numbers("viewMatrix", values)) camera.viewMatrix = values;
        if (lookAtGiven) fields.error("viewMatrix", "stands beside eye, target or up; give one or the other");
    } else if (matrix || lookAtGiven) {
        camera.viewMatrix.reset();
    }
}

void readCamera(FieldReader& parent, Camera& camera) {
    const auto* object = parent.find("camera");
    if (!object) return;
    FieldReader fields(*object, parent.path("camera"));
    word(fields, "type", values::projection, [&](Projection type) { camera.projection = type; });
    bool lookAtGiven = fields.vector("eye", camera.eye);
    lookAtGiven |= fields.vector("target", camera.target);
    lookAtGiven |= fields.vector("up", camera.up);
    readMatrix(fields, lookAtGiven, camera);
    fields.number("fov", camera.fov);
    fields.number("viewHeight", camera.viewHeight);
    fields.number("near", camera.near);
    fields.number("far", camera.far);
    if (auto result = fields.finishStrict(); !result) parent.error(result.error());
}

void readParameters(FieldReader& parent, ParameterValues& parameters) {
    const auto* object = parent.find("param");
    if (!object) return;
    if (!object->is_object()) return parent.error("param", "expected an object, such as {\"sizePx\": 5}");
    for (const auto& item : object->items()) {
        const auto& value = item.value();
        if (value.is_null())
            parameters.erase(item.key());
        else if (value.is_boolean())
            parameters[item.key()] = value.get<bool>();
        else if (value.is_number())
            parameters[item.key()] = value.get<double>();
        else if (value.is_string())
            parameters[item.key()] = value.get<std::string>();
        else
            return parent.error("param", "the value of " + quoteText(item.key()) +
                                             " must be a number, a string, true or false");
    }
}

void readClasses(FieldReader& fields, std::optional<std::vector<std::uint8_t>>& classes) {
    const auto* array = fields.find("classes");
    if (!array) return;
    if (array->is_null()) return classes.reset();
    if (!array->is_array() || array->size() > 256)
        return fields.error("classes", "expected null or an array of at most 256 class numbers");
    std::vector<std::uint8_t> result;
    for (const auto& item : *array) {
        if (!item.is_number_integer() || item < 0 || item > 255)
            return fields.error("classes", "a class is a whole number from 0 to 255");
        result.push_back(item.get<std::uint8_t>());
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    classes = std::move(result);
}

void readClip(FieldReader& parent, std::optional<ClipBox>& clip) {
    const auto* object = parent.find("clip");
    if (!object) return;
    if (object->is_null()) return clip.reset();
    FieldReader fields(*object, parent.path("clip"));
    ClipBox box{};
    for (const auto& [key, corner] :
         {std::pair<std::string_view, glm::dvec3*>{"min", &box.min}, {"max", &box.max}})
        if (fields.require(key)) fields.vector(key, *corner);
    if (auto result = fields.finishStrict(); !result)
        parent.error(result.error());
    else
        clip = box;
}

void readBackground(FieldReader& fields, Background& background) {
    const auto* value = fields.find("background");
    if (!value) return;
    if (value->is_null()) {
        background = {};
        return;
    }
    std::string text;
    if (value->is_string())
        text = value->get<std::string>();
    else if (value->is_array() && value->size() == 2 && (*value)[0].is_string() && (*value)[1].is_string())
        text = (*value)[0].get<std::string>() + "," + (*value)[1].get<std::string>();
    else
        return fields.error("background",
                            "expected \"transparent\", \"#rrggbb\" or [\"#rrggbb\", \"#rrggbb\"]");
    if (const auto parsed = values::background(text))
        background = *parsed;
    else
        fields.error("background", parsed.error());
}

void readStyle(FieldReader& fields, Style& style) {
    if (fields.text("method", style.method, 64)) style.parameters.clear();
    readParameters(fields, style.parameters);
    word(fields, "color", values::color, [&](const values::Color& color) {
        style.color = color.source;
        style.flatColor = color.flat;
    });
    word(fields, "colormap", values::colormap, [&](const std::string& map) { style.colormap = map; });
    if (const auto* range = fields.find("range")) {
        std::array<double, 2> ends{};
        if (range->is_null())
            style.range.reset();
        else if (fields.numbers("range", ends))
            style.range = ends;
    }
    readClasses(fields, style.classes);
    readClip(fields, style.clip);
    if (const auto* shading = fields.find("shading"); shading && shading->is_null())
        style.shading.reset();
    else
        word(fields, "shading", values::shading, [&](Shading value) { style.shading = value; });
    fields.flag("mirrors", style.mirrors);
    fields.flag("behindMirrors", style.behindMirrors);
    readBackground(fields, style.background);
}

void readQuality(FieldReader& fields, Quality& quality) {
    fields.number("detail", quality.detail);
    fields.integer("budget", quality.budget, 1, UINT64_MAX);
    fields.integer("samples", quality.samples, 1, 64);
    fields.integer("quality", quality.jpegQuality, 1, 100);
    word(fields, "subsampling", values::subsampling, [&](Subsampling value) { quality.subsampling = value; });
}

/// validate() names words; in JSON the camera's words lie inside "camera", and projection is its type.
Error atJsonPath(Error error) {
    constexpr std::array<std::string_view, 8> cameraWords{"eye", "target",     "up",   "viewMatrix",
                                                          "fov", "viewHeight", "near", "far"};
    if (std::find(cameraWords.begin(), cameraWords.end(), error.field) != cameraWords.end())
        error.field = "camera." + error.field;
    return error;
}

template <class T>
json orNull(const std::optional<T>& value) {
    return value ? json(*value) : json();
}

json toJson(const Camera& camera) {
    json object = {
        {"type", name(camera.projection)}, {"near", orNull(camera.near)}, {"far", orNull(camera.far)}};
    if (camera.viewMatrix) {
        object["viewMatrix"] = *camera.viewMatrix;
    } else {
        object["eye"] = jsonArray(camera.eye);
        object["target"] = jsonArray(camera.target);
        object["up"] = jsonArray(camera.up);
    }
    if (camera.projection == Projection::Perspective)
        object["fov"] = camera.fov;
    else
        object["viewHeight"] = camera.viewHeight;
    return object;
}

json toJson(const Background& background) {
    switch (background.kind) {
        case Background::Kind::Transparent:
            return "transparent";
        case Background::Kind::Color:
            return values::print(background.top);
        case Background::Kind::Gradient:
            break;
    }
    return json::array({values::print(background.top), values::print(background.bottom)});
}

json toJson(const ParameterValues& parameters) {
    json object = json::object();
    for (const auto& [key, value] : parameters)
        std::visit([&, &at = key](const auto& v) { object[at] = v; }, value);
    return object;
}

}  // namespace

Expected<View> applyJson(const View& base, const json& changes) {
    View view = base;
    FieldReader fields(changes);
    readCamera(fields, view.camera);
    fields.integer("width", view.width, 1, maxPictureSide);
    fields.integer("height", view.height, 1, maxPictureSide);
    readStyle(fields, view.style);
    readQuality(fields, view.quality);
    if (auto result = fields.finishStrict(); !result) return tl::unexpected(result.error());
    if (auto sound = validate(view); !sound) return tl::unexpected(atJsonPath(sound.error()));
    return view;
}

json toJson(const View& view) {
    const auto& style = view.style;
    const auto& quality = view.quality;
    return {
        {"camera", toJson(view.camera)},
        {"width", view.width},
        {"height", view.height},
        {"method", style.method},
        {"param", toJson(style.parameters)},
        {"color",
         style.color == ColorSource::Flat ? values::print(style.flatColor) : std::string(name(style.color))},
        {"colormap", style.colormap},
        {"range", orNull(style.range)},
        {"classes", orNull(style.classes)},
        {"clip", style.clip ? json{{"min", jsonArray(style.clip->min)}, {"max", jsonArray(style.clip->max)}}
                            : json()},
        {"shading", style.shading ? json(name(*style.shading)) : json()},
        {"mirrors", style.mirrors},
        {"behindMirrors", style.behindMirrors},
        {"background", toJson(style.background)},
        {"detail", orNull(quality.detail)},
        {"budget", orNull(quality.budget)},
        {"samples", orNull(quality.samples)},
        {"quality", quality.jpegQuality},
        {"subsampling", name(quality.subsampling)},
    };
}

}  // namespace scancast
