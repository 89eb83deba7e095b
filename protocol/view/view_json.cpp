#include "protocol/view/view_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using nlohmann::json;

/// The member of the view's object that the word lies in: "camera", "light"; empty: in none.
std::string_view objectOf(const ViewWord& word) {
    const auto dot = word.path.find('.');
    return dot == std::string_view::npos ? std::string_view() : word.path.substr(0, dot);
}

std::string_view keyOf(const ViewWord& word) {
    const auto object = objectOf(word);
    return object.empty() ? word.path : word.path.substr(object.size() + 1);
}

void readObject(FieldReader& parent, std::string_view name, View& view) {
    const auto* object = parent.find(name);
    if (!object) return;
    FieldReader fields(*object, parent.path(name));
    for (const auto& word : viewWords())
        if (objectOf(word) == name) word.value.read(view, fields, keyOf(word));
    if (auto result = fields.finishStrict(); !result) parent.error(result.error());
}

/// An object is read where the first of its words stands in the table; there they stand together.
void readWords(FieldReader& fields, View& view) {
    std::string_view last;
    for (const auto& word : viewWords()) {
        const auto object = objectOf(word);
        if (object.empty()) word.value.read(view, fields, word.path);
        if (!object.empty() && object != last) readObject(fields, object, view);
        last = object;
    }
}

/// validate() names words; in JSON some lie inside an object.
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
    readWords(fields, view);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    if (auto sound = validate(view); !sound) return tl::unexpected(atJsonPath(sound.error()));
    return view;
}

json toJson(const View& view) {
    json whole;
    for (const auto& word : viewWords()) {
        if (!word.value.matters(view)) continue;
        json& object = objectOf(word).empty() ? whole : whole[std::string(objectOf(word))];
        object[std::string(keyOf(word))] = word.value.print(view);
    }
    return whole;
}

}  // namespace scancast
