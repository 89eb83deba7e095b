#include "protocol/look.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/json_fields.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast {
namespace {

using nlohmann::json;

/// Of the picture's width or height, at each end.
constexpr double margin = 0.06;
constexpr double usualAspect = 16.0 / 9, widestFov = 90;
constexpr std::size_t longestLookName = 64, longestLookReason = 4096;

/// The members of a view that its style is printed as: all but camera, size, quality and other clouds.
constexpr std::array<std::string_view, 8> notOfStyle{"camera", "width",   "height",  "detail",
                                                     "budget", "samples", "quality", "with"};
/// Those that are printed where they say something: programs that do not know them read every other look, and the cloud file that it
/// is in.
constexpr std::array<std::string_view, 1> youngWords{"filter"};

bool isOfStyle(std::string_view key) {
    return key != "subsampling" && std::ranges::find(notOfStyle, key) == notOfStyle.end();
}

json styleJson(const Style& style) {
    View view;
    view.style = style;
    json all = toJson(view), own = json::object();
    for (auto& [key, value] : all.items())
        if (isOfStyle(key) && !(value.is_null() && std::ranges::find(youngWords, key) != youngWords.end()))
            own[key] = std::move(value);
    return own;
}

json viewJson(const LookView& view) {
    View of;
    of.camera = view.camera;
    return {{"name", view.name}, {"inside", view.inside}, {"camera", toJson(of).at("camera")}};
}

void readStyle(FieldReader& fields, Style& style) {
    const json* value = fields.findValue("style");
    if (!value) return;
    if (!value->is_object()) return fields.error("style", "expected an object");
    for (const auto& [key, word] : value->items())
        if (!isOfStyle(key)) return fields.error("style", "'" + key + "' is no word of a style");
    View base;
    base.style = style;
    // Who says everything else, as styleJson() does, says by silence that there is no filter.
    const json all = styleJson(Style{});
    const auto isSaid = [&](const auto& word) { return value->contains(word.key()); };
    if (std::ranges::all_of(all.items(), isSaid)) base.style.filter.clear();
    const auto view = applyJson(base, *value);
    if (!view) return fields.error({view.error().code, view.error().message, fields.path("style")});
    style = view->style;
}

bool readCamera(FieldReader& fields, Camera& camera) {
    const json* value = fields.require("camera");
    if (!value) return false;
    const auto view = applyJson(View{}, json{{"camera", *value}});
    if (!view) {
        fields.error({view.error().code, view.error().message, fields.path("camera")});
        return false;
    }
    camera = view->camera;
    return true;
}

void readViews(FieldReader& fields, std::vector<LookView>& views) {
    const json* list = fields.findValue("views");
    if (!list) return;
    if (!list->is_array() || list->empty() || list->size() > Look::mostViews)
        return fields.error("views", "expected a list of one to six views");
    views.clear();
    for (std::size_t i = 0; i < list->size(); ++i) {
        FieldReader entry((*list)[i], fields.path("views") + "[" + std::to_string(i) + "]");
        LookView& view = views.emplace_back();
        entry.text("name", view.name, longestLookName);
        entry.flag("inside", view.inside);
        readCamera(entry, view.camera);
        if (auto sound = entry.finishStrict(); !sound) return fields.error(sound.error());
    }
}

bool readPoint(const json& value, glm::dvec3& point) {
    if (!value.is_array() || value.size() != 3) return false;
    for (int a = 0; a < 3; ++a) {
        const json& number = value[std::size_t(a)];
        if (!number.is_number() || !std::isfinite(number.get<double>())) return false;
        point[a] = number.get<double>();
    }
    return true;
}

void readOutline(FieldReader& fields, std::vector<glm::dvec3>& outline) {
    const json* list = fields.findValue("outline");
    if (!list) return;
    if (!list->is_array() || list->empty() || list->size() > Look::mostOutline)
        return fields.error("outline", "expected a list of 1 to 256 points");
    outline.assign(list->size(), {});
    for (std::size_t i = 0; i < list->size(); ++i)
        if (!readPoint((*list)[i], outline[i])) return fields.error("outline", "expected points [x, y, z]");
}

void readBounds(FieldReader& fields, std::array<glm::dvec3, 2>& bounds) {
    const json* value = fields.findValue("bounds");
    if (!value) return;
    FieldReader box(*value, fields.path("bounds"));
    box.vector("min", bounds[0]);
    box.vector("max", bounds[1]);
    if (auto sound = box.finishStrict(); !sound) return fields.error(sound.error());
    for (int a = 0; a < 3; ++a)
        if (!(bounds[0][a] <= bounds[1][a])) return fields.error("bounds", "min is above max");
}

void readKind(FieldReader& fields, SceneKind& kind) {
    std::string text;
    if (!fields.text("kind", text)) return;
    const auto found = std::ranges::find(sceneKindNames, text);
    if (found == sceneKindNames.end())
        return fields.error("kind", "expected airborne, street, indoor, object or depth-frame");
    kind = SceneKind(found - sceneKindNames.begin());
}

/// Axes of a camera: right, up, and back, from the target to the eye.
struct Axes {
    glm::dvec3 right, up, back;
};

Axes axesOf(const Camera& camera) {
    Axes axes;
    axes.back = glm::normalize(camera.eye - camera.target);
    axes.right = glm::normalize(glm::cross(camera.up, axes.back));
    axes.up = glm::cross(axes.back, axes.right);
    return axes;
}

/// How far points reach to both sides of a line of sight, as the eye's least distance at which `tan` still
/// holds them: |x| ≤ tan · (distance - z).
struct Reach {
    double positive = -INFINITY, negative = -INFINITY;
    void add(double x, double z, double tan) {
        positive = std::max(positive, z + x / tan);
        negative = std::max(negative, z - x / tan);
    }
    double distance() const { return (positive + negative) / 2; }
    double offset(double tan) const { return tan * (positive - negative) / 2; }
};

Camera fittedPerspective(Camera camera, const std::vector<glm::dvec3>& outline, double aspect) {
    const Axes axes = axesOf(camera);
    const double tanUp = std::tan(camera.fov * std::numbers::pi / 360) * (1 - 2 * margin);
    const double tanRight = tanUp * aspect;
    Reach wide, high;
    double nearest = -INFINITY, farthest = INFINITY, size = 0;
    for (const glm::dvec3& point : outline) {
        const glm::dvec3 p = point - camera.target;
        const double z = glm::dot(p, axes.back);
        wide.add(glm::dot(p, axes.right), z, tanRight);
        high.add(glm::dot(p, axes.up), z, tanUp);
        nearest = std::max(nearest, z);
        farthest = std::min(farthest, z);
        size = std::max(size, glm::length(point - outline.front()));
    }
    // One point has no size: it is looked at from a distance at which the eye differs from the target.
    const double least = std::max(glm::length(camera.target) * 1e-9, 1e-9);
    const double distance = std::max({wide.distance(), high.distance(), nearest + 1e-3 * size});
    // What is looked at lies among the points, or the eye could be beyond it.
    const double shift = std::clamp(0.0, farthest, nearest);
    camera.target += axes.right * wide.offset(tanRight) + axes.up * high.offset(tanUp) + axes.back * shift;
    camera.eye = camera.target + axes.back * std::max(distance - shift, least);
    return camera;
}

Camera fittedOrthographic(Camera camera, const std::vector<glm::dvec3>& outline, double aspect) {
    const Axes axes = axesOf(camera);
    std::array<glm::dvec3, 2> box{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)};
    for (const glm::dvec3& point : outline) {
        const glm::dvec3 p = point - camera.target;
        const glm::dvec3 q(glm::dot(p, axes.right), glm::dot(p, axes.up), glm::dot(p, axes.back));
        box = {glm::min(box[0], q), glm::max(box[1], q)};
    }
    const glm::dvec3 size = box[1] - box[0], middle = (box[0] + box[1]) * 0.5;
    const double least = std::max(glm::length(camera.target) * 1e-9, 1e-9);
    const double shift = std::clamp(0.0, box[0].z, box[1].z);
    camera.target += axes.right * middle.x + axes.up * middle.y + axes.back * shift;
    camera.viewHeight = std::max(std::max(size.y, size.x / aspect) / (1 - 2 * margin), least);
    camera.eye = camera.target + axes.back * std::max(box[1].z - shift + camera.viewHeight, least);
    return camera;
}

/// Higher pictures show as much from left to right as one of 16:9, up to what does not look distorted.
Camera widened(Camera camera, double aspect) {
    if (camera.projection != Projection::Perspective || !(aspect > 0 && aspect < usualAspect)) return camera;
    const double half = std::atan(std::tan(camera.fov * std::numbers::pi / 360) * usualAspect / aspect);
    camera.fov = std::max(camera.fov, std::min(half * 360 / std::numbers::pi, widestFov));
    return camera;
}

}  // namespace

Camera fitted(const Camera& camera, const std::vector<glm::dvec3>& outline, double aspect) {
    if (outline.empty()) return camera;
    if (!(aspect > 0 && std::isfinite(aspect))) aspect = 1;
    return camera.projection == Projection::Perspective ? fittedPerspective(camera, outline, aspect)
                                                        : fittedOrthographic(camera, outline, aspect);
}

Camera cameraFor(const Look& look, const LookView& view, double aspect) {
    if (view.camera.viewMatrix) return view.camera;
    if (view.inside) return widened(view.camera, aspect);
    return fitted(view.camera, look.outline, aspect);
}

json toJson(const Look& look) {
    json outline = json::array(), views = json::array();
    for (const glm::dvec3& point : look.outline) outline.push_back(jsonArray(point));
    for (const LookView& view : look.views) views.push_back(viewJson(view));
    return {{"kind", name(look.kind)},
            {"reason", look.reason},
            {"up", jsonArray(look.up)},
            {"bounds", {{"min", jsonArray(look.bounds[0])}, {"max", jsonArray(look.bounds[1])}}},
            {"outline", std::move(outline)},
            {"noise", look.noise},
            {"style", styleJson(look.style)},
            {"views", std::move(views)}};
}

Expected<Look> applyLook(const Look& base, const json& changes) {
    Look look = base;
    FieldReader fields(changes);
    readKind(fields, look.kind);
    fields.text("reason", look.reason, longestLookReason);
    if (fields.vector("up", look.up) && !(std::abs(glm::length(look.up) - 1) <= 1e-6))
        fields.error("up", "expected a vector of length 1");
    readBounds(fields, look.bounds);
    readOutline(fields, look.outline);
    if (fields.number("noise", look.noise) && !(look.noise >= 0))
        fields.error("noise", "must not be negative");
    readStyle(fields, look.style);
    readViews(fields, look.views);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return look;
}

Expected<void> validate(const Look& look) {
    if (look.views.empty()) return fail(ErrorCode::InvalidArgument, "a look needs a view", "views");
    if (look.outline.empty()) return fail(ErrorCode::InvalidArgument, "a look needs an outline", "outline");
    return {};
}

}  // namespace scancast
