// The word `with` as text and as JSON.
#include "protocol/nearest_name.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast::values {
namespace {

using nlohmann::json;

constexpr std::string_view shiftWord = "shift:", tintWord = "tint:", hiddenWord = "hidden";

tl::unexpected<std::string> tooManyClouds() {
    return tl::unexpected("there are more than " + std::to_string(mostViewedClouds) + " clouds");
}

tl::unexpected<std::string> saidTwice(std::string_view what, const ViewedCloud& of) {
    return tl::unexpected("of " + quoteText(of.cloud) + ", " + std::string(what) + " is said twice");
}

/// Three numbers with colons between them, because commas and semicolons have another meaning here.
Parsed<glm::dvec3> parseShift(std::string_view text) {
    std::string commas(text);
    for (char& c : commas) {
        if (c == ',') return tl::unexpected(std::string("a shift is DX:DY:DZ"));
        if (c == ':') c = ',';
    }
    auto shift = parse<glm::dvec3>(commas);
    if (shift) return shift;
    return tl::unexpected("a shift is DX:DY:DZ, three numbers with colons between them, unlike " +
                          quoteText(text));
}

/// What stands behind a cloud's name.
tl::expected<void, std::string> applyPart(std::string_view part, ViewedCloud& out, bool& shifted) {
    if (part == hiddenWord) {
        if (out.hidden) return saidTwice(hiddenWord, out);
        out.hidden = true;
        return {};
    }
    if (part.starts_with(shiftWord)) {
        const auto shift = parseShift(part.substr(shiftWord.size()));
        if (!shift) return passOn(shift);
        if (shifted) return saidTwice("shift", out);
        out.shift = *shift;
        shifted = true;
        return {};
    }
    if (part.starts_with(tintWord)) {
        const auto tint = parse<Rgb8>(part.substr(tintWord.size()));
        if (!tint) return passOn(tint);
        if (out.tint) return saidTwice("tint", out);
        out.tint = *tint;
        return {};
    }
    return tl::unexpected(
        quoteText(part) +
        " says nothing of a cloud: write shift:DX:DY:DZ, tint:RRGGBB or hidden, with commas "
        "between them and ; between clouds");
}

Parsed<ViewedCloud> parseViewedCloud(std::string_view text) {
    ViewedCloud made;
    const auto comma = text.find(',');
    made.cloud = std::string(text.substr(0, comma));
    if (made.cloud.empty()) return tl::unexpected(std::string("a cloud has no name"));
    bool shifted = false;
    for (std::size_t at = comma; at != std::string_view::npos;) {
        const auto end = text.find(',', at + 1);
        const auto part = text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
        if (const auto ok = applyPart(part, made, shifted); !ok) return passOn(ok);
        at = end;
    }
    return made;
}

bool readViewedCloud(FieldReader& fields, ViewedCloud& out) {
    if (fields.require("cloud")) fields.text("cloud", out.cloud, longestCloudName);
    if (fields.findValue("shift")) fields.vector("shift", out.shift);
    if (fields.find("tint")) read(fields, "tint", out.tint);
    if (fields.findValue("hidden")) fields.flag("hidden", out.hidden);
    return !fields.failed();
}

}  // namespace

Parsed<ViewedClouds> parse(As<ViewedClouds>, std::string_view text) {
    ViewedClouds clouds;
    if (text == "auto") return clouds;
    for (std::string_view rest = text;;) {
        if (clouds.size() == mostViewedClouds) return tooManyClouds();
        const auto end = rest.find(';');
        auto one = parseViewedCloud(rest.substr(0, end));
        if (!one) return passOn(one);
        clouds.push_back(std::move(*one));
        if (end == std::string_view::npos) return clouds;
        rest.remove_prefix(end + 1);
    }
}

bool read(FieldReader& parent, std::string_view key, ViewedClouds& out) {
    const auto* const list = parent.find(key);
    if (!list) return false;
    ViewedClouds clouds;
    if (!list->is_array() && !list->is_null()) {
        parent.error(
            key,
            R"(expected null or an array of clouds, such as {"cloud": "town-2024", "shift": [0, 0, 0.1]})");
        return false;
    }
    if (list->size() > mostViewedClouds) {
        parent.error(key, tooManyClouds().value());
        return false;
    }
    for (const json& item : *list) {
        FieldReader fields(item, parent.path(key) + "[" + std::to_string(clouds.size()) + "]");
        readViewedCloud(fields, clouds.emplace_back());
        if (auto done = fields.finishStrict(); !done) {
            parent.error(done.error());
            return false;
        }
    }
    out = std::move(clouds);
    return true;
}

json print(const ViewedClouds& clouds) {
    if (clouds.empty()) return {};
    json list = json::array();
    for (const ViewedCloud& one : clouds)
        list.push_back({{"cloud", one.cloud},
                        {"shift", print(one.shift)},
                        {"tint", one.tint ? json(print(*one.tint)) : json()},
                        {"hidden", one.hidden}});
    return list;
}

}  // namespace scancast::values
