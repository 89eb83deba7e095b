#include "protocol/add_cloud.hpp"

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {

Expected<AddCloud> parseAddCloud(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    constexpr std::size_t longestPath = 4096;
    AddCloud asked;
    FieldReader fields(*value);
    if (fields.require("file")) fields.text("file", asked.file, longestPath);
    if (fields.findValue("id")) fields.text("id", asked.id);
    if (fields.findValue("title")) fields.text("title", asked.title);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return asked;
}

}  // namespace scancast
