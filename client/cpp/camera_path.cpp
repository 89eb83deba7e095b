#include "client/cpp/camera_path.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast::client {
namespace {

Error inside(const std::string& path, Error error) {
    error.message = path + error.message;
    if (!error.field.empty()) error.field = path + error.field;
    return error;
}

/// The speed at a key: of the parabola through it and its neighbours; at an end, the mean speed beside it.
glm::dvec3 speedAt(const std::vector<CameraKey>& keys, std::size_t i, glm::dvec3 Camera::*part) {
    const auto slope = [&](std::size_t a, std::size_t b) {
        return (keys[b].camera.*part - keys[a].camera.*part) / (keys[b].time - keys[a].time);
    };
    if (i == 0) return slope(0, 1);
    if (i + 1 == keys.size()) return slope(i - 1, i);
    const double before = keys[i].time - keys[i - 1].time, after = keys[i + 1].time - keys[i].time;
    return (slope(i - 1, i) * after + slope(i, i + 1) * before) / (before + after);
}

/// Cubic Hermite between key i and the next, s in [0, 1].
glm::dvec3 between(const std::vector<CameraKey>& keys, std::size_t i, double s, glm::dvec3 Camera::*part) {
    const double length = keys[i + 1].time - keys[i].time;
    const double s2 = s * s, s3 = s2 * s;
    return keys[i].camera.*part * (2 * s3 - 3 * s2 + 1) +
           speedAt(keys, i, part) * (length * (s3 - 2 * s2 + s)) +
           keys[i + 1].camera.*part * (3 * s2 - 2 * s3) + speedAt(keys, i + 1, part) * (length * (s3 - s2));
}

double even(double from, double to, double s) {
    return from + (to - from) * s;
}

/// Automatic at either end means automatic on the way there.
std::optional<double> even(const std::optional<double>& from, const std::optional<double>& to, double s) {
    return from && to ? std::optional(even(*from, *to, s)) : std::nullopt;
}

Expected<CameraKey> readKey(const nlohmann::json& value, const std::string& path, const View& view,
                            const CameraKey* before) {
    if (!value.is_object())
        return fail(ErrorCode::InvalidArgument, path + ": must be an object with a camera", path);
    FieldReader fields(value, path);
    CameraKey key{before ? before->time + 1 : 0, {}};
    fields.number("time", key.time);
    const auto* camera = fields.find("camera");
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    View from = view;
    if (before) from.camera = before->camera;
    const auto moved =
        applyJson(from, camera ? nlohmann::json{{"camera", *camera}} : nlohmann::json::object());
    if (!moved) return tl::unexpected(inside(path + ".", moved.error()));
    key.camera = moved->camera;
    return key;
}

Expected<void> checkKeys(const std::vector<CameraKey>& keys) {
    if (keys.size() < 2) return fail(ErrorCode::InvalidArgument, "keys: a path needs two of them", "keys");
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const auto path = "keys[" + std::to_string(i) + "]";
        if (keys[i].camera.viewMatrix)
            return fail(ErrorCode::InvalidArgument,
                        path + ": a path is made of eye and target, not of viewMatrix",
                        path + ".camera.viewMatrix");
        if (keys[i].camera.projection != keys[0].camera.projection)
            return fail(ErrorCode::InvalidArgument, path + ": the projection changes on the way",
                        path + ".camera.type");
        if (i > 0 && !(keys[i].time > keys[i - 1].time))
            return fail(ErrorCode::InvalidArgument, path + ": must be later than the key before",
                        path + ".time");
    }
    return {};
}

}  // namespace

View CameraPath::at(double time) const {
    const double now = std::clamp(time, keys.front().time, keys.back().time);
    const auto after =
        std::find_if(keys.begin() + 1, keys.end() - 1, [&](const CameraKey& key) { return key.time > now; });
    const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
    const auto& from = keys[i].camera;
    const auto& to = keys[i + 1].camera;
    const double s = (now - keys[i].time) / (keys[i + 1].time - keys[i].time);
    View result = view;
    auto& camera = result.camera;
    camera = from;
    camera.eye = between(keys, i, s, &Camera::eye);
    camera.target = between(keys, i, s, &Camera::target);
    camera.up = between(keys, i, s, &Camera::up);
    camera.fov = even(from.fov, to.fov, s);
    camera.viewHeight = even(from.viewHeight, to.viewHeight, s);
    camera.near = even(from.near, to.near, s);
    camera.far = even(from.far, to.far, s);
    return result;
}

Expected<CameraPath> parseCameraPath(std::string_view json, const View& base) {
    const auto value = parseJson(json);
    if (!value) return passOn(value);
    if (!value->is_object())
        return fail(ErrorCode::Malformed, "a path is a JSON object, such as {\"keys\": [...]}");
    FieldReader fields(*value);
    const auto* view = fields.find("view");
    const auto* keys = fields.require("keys");
    if (keys && !keys->is_array()) fields.error("keys", "must be an array of objects with a camera");
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    const auto changed = applyJson(base, view ? *view : nlohmann::json::object());
    if (!changed) return tl::unexpected(inside("view.", changed.error()));
    CameraPath path{*changed, {}};
    for (const auto& entry : *keys) {
        const auto name = "keys[" + std::to_string(path.keys.size()) + "]";
        auto key = readKey(entry, name, path.view, path.keys.empty() ? nullptr : &path.keys.back());
        if (!key) return passOn(std::move(key));
        path.keys.push_back(std::move(*key));
    }
    if (auto ok = checkKeys(path.keys); !ok) return passOn(ok);
    return path;
}

}  // namespace scancast::client
