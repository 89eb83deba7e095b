#include "protocol/json_text.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <vector>

#include "protocol/nearest_name.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

/// Checked before parsing, so that hostile nesting costs one pass over the text and no memory. Returns how many keys there are where the
/// text is JSON: outside strings, each colon stands behind one.
Expected<std::size_t> checkDepth(std::string_view text) {
    int depth = 0;
    std::size_t keys = 0;
    bool inString = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                inString = false;
        } else if (c == '"') {
            inString = true;
        } else if (c == '{' || c == '[') {
            if (++depth > maxJsonDepth)
                return fail(ErrorCode::Malformed, "the JSON nests deeper than " +
                                                      std::to_string(maxJsonDepth) + " levels at byte " +
                                                      std::to_string(i));
        } else if (c == '}' || c == ']') {
            --depth;
        } else if (c == ':') {
            ++keys;
        }
    }
    return keys;
}

/// Its own and those of all that lies in it; no deeper than checkDepth() lets it be.
std::size_t membersOf(const nlohmann::json& value) {
    std::size_t count = value.is_object() ? value.size() : 0;
    if (value.is_structured())
        for (const nlohmann::json& inner : value) count += membersOf(inner);
    return count;
}

/// The library keeps the last of two equal keys; whoever sends both means neither for certain.
struct RepeatedKey {
    std::vector<std::set<std::string>> open;
    std::string found;

    void operator()(nlohmann::json::parse_event_t event, const nlohmann::json& value) {
        using Event = nlohmann::json::parse_event_t;
        if (event == Event::object_start) open.emplace_back();
        if (event == Event::object_end && !open.empty()) open.pop_back();
        if (event == Event::key && !open.empty() && !open.back().insert(value.get<std::string>()).second &&
            found.empty())
            found = value.get<std::string>();
    }
};

/// "[json.exception.parse_error.101] parse error at line 1, column 3: …" without the library's tag.
std::string reason(const std::exception& error) {
    std::string_view what = error.what();
    if (const auto end = what.find("] "); what.starts_with('[') && end != std::string_view::npos)
        what.remove_prefix(end + 2);
    constexpr std::size_t longest = 200;  // the library quotes what it read last, however long that is
    return what.size() > longest ? plainText(what.substr(0, longest)) + "…" : plainText(what);
}

}  // namespace

Expected<nlohmann::json> parseJson(std::string_view text) {
    const auto keys = checkDepth(text);
    if (!keys) return passOn(keys);
    try {
        auto value = nlohmann::json::parse(text.begin(), text.end());
        if (membersOf(value) == *keys) return value;
        // Which key it is needs a second look, and memory for each.
        RepeatedKey repeated;
        std::ignore = nlohmann::json::parse(
            text.begin(), text.end(),
            [&](int /*depth*/, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
                repeated(event, parsed);
                return true;
            });
        return fail(ErrorCode::Malformed,
                    "the JSON has the key " + quoteText(repeated.found) + " twice in one object",
                    repeated.found);
    } catch (const nlohmann::json::exception& error) {
        return fail(ErrorCode::Malformed, "not JSON: " + reason(error));
    }
}

void dismantle(nlohmann::json& value) noexcept {
    if (!value.is_structured()) return;
    for (nlohmann::json& inner : value) dismantle(inner);
    value.clear();
}

std::string printJson(const nlohmann::json& value) {
    return plainJson(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace scancast
