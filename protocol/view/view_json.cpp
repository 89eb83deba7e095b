#include "protocol/view/view_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr std::string_view camera = "camera.";

bool isOfCamera(const ViewWord& word) {
    return word.path.starts_with(camera);
}

std::string_view keyOf(const ViewWord& word) {
    return isOfCamera(word) ? word.path.substr(camera.size()) : word.path;
}

void readWords(FieldReader& fields, bool ofCamera, View& view) {
    for (const auto& word : viewWords())
        if (isOfCamera(word) == ofCamera) word.value.read(view, fields, keyOf(word));
}

void readCamera(FieldReader& parent, View& view) {
    const auto* object = parent.find("camera");
    if (!object) return;
    FieldReader fields(*object, parent.path("camera"));
    readWords(fields, true, view);
    if (auto result = fields.finishStrict(); !result) parent.error(result.error());
}

/// validate() names words; in JSON the camera's lie inside "camera".
Error atJsonPath(Error error) {
    const auto words = viewWords();
    const auto word =
        std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.word == error.field; });
    if (word != words.end()) error.field = word->path;
    return error;
}

}  // namespace

Expected<View> applyJson(const View& base, const json& changes) {
    View view = base;
    FieldReader fields(changes);
    readCamera(fields, view);
    readWords(fields, false, view);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    if (auto sound = validate(view); !sound) return tl::unexpected(atJsonPath(sound.error()));
    return view;
}

json toJson(const View& view) {
    json object, cameraObject;
    for (const auto& word : viewWords())
        if (word.value.matters(view))
            (isOfCamera(word) ? cameraObject : object)[std::string(keyOf(word))] = word.value.print(view);
    object["camera"] = std::move(cameraObject);
    return object;
}

}  // namespace scancast
