// The word `filter` as text and as JSON.
#include <algorithm>

#include "protocol/nearest_name.hpp"
#include "protocol/view/hex_digit.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast::values {
namespace {

using nlohmann::json;

tl::unexpected<std::string> tooManyRanges() {
    return tl::unexpected("there are more than " + std::to_string(mostColumnRanges) + " ranges");
}

/// Two digits behind each %.
Parsed<std::string> unescaped(std::string_view name) {
    std::string plain;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] != '%') {
            plain += name[i];
            continue;
        }
        const int high = i + 2 < name.size() ? hexDigit(name[i + 1]) : -1;
        const int low = i + 2 < name.size() ? hexDigit(name[i + 2]) : -1;
        if (high < 0 || low < 0)
            return tl::unexpected("a % in a column's name is written %25, unlike in " + quoteText(name));
        plain += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return plain;
}

tl::expected<void, std::string> parseEnd(std::string_view text, std::optional<double>& out) {
    if (text.empty()) return {};
    const auto number = parse<double>(text);
    if (!number) return passOn(number);
    out = *number;
    return {};
}

/// A name may have colons: what stands behind the last is the range.
Parsed<ColumnRange> parseRange(std::string_view text) {
    const auto colon = text.rfind(':');
    const auto ends = colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
    const auto dots = ends.find("..");
    if (colon == std::string_view::npos || dots == std::string_view::npos)
        return tl::unexpected(quoteText(text) +
                              " is no range: write NAME:LOW..HIGH, NAME:LOW.. or NAME:..HIGH, with ; between "
                              "ranges");
    auto name = unescaped(text.substr(0, colon));
    if (!name) return passOn(name);
    ColumnRange range{std::move(*name), {}, {}};
    if (auto ok = parseEnd(ends.substr(0, dots), range.low); !ok) return passOn(ok);
    if (auto ok = parseEnd(ends.substr(dots + 2), range.high); !ok) return passOn(ok);
    return range;
}

bool readRange(FieldReader& fields, ColumnRange& out) {
    if (fields.require("column") != nullptr) fields.text("column", out.column, longestColumnName);
    fields.number("low", out.low);
    fields.number("high", out.high);
    return !fields.failed();
}

}  // namespace

Parsed<ColumnRanges> parse(As<ColumnRanges>, std::string_view text) {
    ColumnRanges ranges;
    if (text == "auto") return ranges;
    for (std::string_view rest = text;;) {
        if (ranges.size() == mostColumnRanges) return tooManyRanges();
        const auto end = rest.find(';');
        auto range = parseRange(rest.substr(0, end));
        if (!range) return passOn(range);
        ranges.push_back(std::move(*range));
        if (end == std::string_view::npos) return ranges;
        rest.remove_prefix(end + 1);
    }
}

bool read(FieldReader& parent, std::string_view key, ColumnRanges& out) {
    const auto* const list = parent.find(key);
    if (!list) return false;
    if (!list->is_array() && !list->is_null()) {
        parent.error(key,
                     R"(expected null or an array of ranges, such as {"column": "gps_time", "low": 3600})");
        return false;
    }
    if (list->size() > mostColumnRanges) {
        parent.error(key, tooManyRanges().value());
        return false;
    }
    ColumnRanges ranges;
    for (const json& item : *list) {
        FieldReader fields(item, parent.path(key) + "[" + std::to_string(ranges.size()) + "]");
        readRange(fields, ranges.emplace_back());
        if (auto done = fields.finishStrict(); !done) {
            parent.error(done.error());
            return false;
        }
    }
    out = std::move(ranges);
    return true;
}

json print(const ColumnRanges& ranges) {
    if (ranges.empty()) return {};
    json list = json::array();
    for (const ColumnRange& range : ranges) {
        json& item = list.emplace_back(json{{"column", range.column}});
        if (range.low) item["low"] = *range.low;
        if (range.high) item["high"] = *range.high;
    }
    return list;
}

}  // namespace scancast::values
