#include "renderer/cloud/columns/column_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "protocol/nearest_name.hpp"
#include "renderer/cloud/exact_columns.hpp"

namespace scancast {
namespace {

std::optional<std::size_t> findColumn(const CloudFacts& facts, std::string_view name) {
    for (const std::size_t c : choosableColumns(facts))
        if (facts.columns[c].column.name == name) return c;
    return std::nullopt;
}

bool hasValue(const CloudFacts& facts, ValueFrom from) {
    if (from == ValueFrom::Intensity) return facts.attributes.intensity || facts.constant.intensity;
    return facts.attributes.classification;
}

/// A message may list so many.
constexpr std::size_t mostListed = 40;

std::string listOf(const CloudFacts& facts) {
    std::string list;
    std::size_t count = 0;
    const auto add = [&](std::string_view name) {
        if (++count > mostListed) return;
        if (!list.empty()) list += ", ";
        list += quoteText(name);
    };
    for (const std::size_t c : choosableColumns(facts)) add(facts.columns[c].column.name);
    if (hasValue(facts, ValueFrom::Intensity)) add(intensityName);
    if (hasValue(facts, ValueFrom::Classification)) add(classificationName);
    if (count > mostListed) list += fmt::format(" and {} more", count - mostListed);
    return list;
}

tl::unexpected<Error> unknown(const CloudFacts& facts, std::string_view name, std::string_view field) {
    const std::string list = listOf(facts);
    std::string message = fmt::format("this cloud keeps no column {}", quoteText(name));
    if (!list.empty()) message += "; there are " + list;
    if (choosableColumns(facts).empty())
        message +=
            "; columns are kept by ingesting the scan with --keep-attributes (scancast ingest SCAN "
            "--keep-attributes -o CLOUD.scan)";
    return fail(ErrorCode::Unsupported, message, std::string(field));
}

Expected<ChosenValue> choose(const CloudFacts& facts, std::string_view name, std::string_view field,
                             bool needsInner) {
    // A kept column of that name goes first: it is what the cloud calls so.
    const auto found = findColumn(facts, name);
    ChosenValue chosen;
    if (name == intensityName) chosen.from = ValueFrom::Intensity;
    if (name == classificationName) chosen.from = ValueFrom::Classification;
    if (!found && chosen.from != ValueFrom::Column && hasValue(facts, chosen.from)) return chosen;
    if (!found) return unknown(facts, name, field);
    if (!isDrawn(facts, facts.columns[*found].column, needsInner))
        return fail(
            ErrorCode::Unsupported,
            fmt::format("the cloud file keeps column {} of its points, but not of what is drawn from "
                        "afar; ingest the scan again with --keep-attributes to colour and filter by it",
                        quoteText(name)),
            std::string(field));
    return ChosenValue{ValueFrom::Column, *found};
}

}  // namespace

std::vector<std::size_t> choosableColumns(const CloudFacts& facts) {
    std::vector<std::size_t> columns;
    std::set<std::string_view> names;
    const auto isExact = [&](const std::string& name) {
        const auto isOf = [&](const ThreeNames& three) {
            return std::ranges::find(three, name) != three.end();
        };
        return facts.exact && (isOf(fullColorNames) || isOf(exactNormalNames) || isOf(exactPositionNames));
    };
    for (std::size_t c = 0; c < facts.columns.size(); ++c) {
        const std::string& name = facts.columns[c].column.name;
        if (!name.empty() && !isExact(name) && names.insert(name).second) columns.push_back(c);
    }
    return columns;
}

bool isDrawn(const CloudFacts& facts, const Column& column, bool hasInnerNodes) {
    if (!hasInnerNodes) return true;
    return std::ranges::find(facts.companions, innerPlane(column)) != facts.companions.end();
}

std::string ColumnChoice::words() const {
    std::string text;
    if (color) text = fmt::format("color {} {} {:a} {:a}", int(color->from), color->column, ends[0], ends[1]);
    for (const ChosenRange& chosen : filter)
        text += fmt::format("; {} {} {} {:a} {} {:a}", int(chosen.value.from), chosen.value.column,
                            chosen.range.low.has_value(), chosen.range.low.value_or(0),
                            chosen.range.high.has_value(), chosen.range.high.value_or(0));
    return text;
}

std::optional<std::array<double, 2>> naturalEnds(const CloudFacts& facts, std::string_view name) {
    const auto narrowed = [](const std::optional<std::array<double, 2>>& usual,
                             const std::array<double, 2>& range) {
        return usual && usual->at(0) < usual->at(1) ? *usual : range;
    };
    if (const auto found = findColumn(facts, name))
        return narrowed(facts.columns[*found].usual, facts.columns[*found].range);
    if (name == classificationName) return std::array{0.0, 255.0};
    if (name != intensityName) return std::nullopt;
    return narrowed(facts.usual ? std::optional(facts.usual->intensity) : std::nullopt,
                    {double(facts.intensityRange[0]), double(facts.intensityRange[1])});
}

Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const ColumnRanges& filter,
                                     bool hasInnerNodes) {
    ColumnChoice choice;
    for (const ColumnRange& range : filter) {
        const auto value = choose(facts, range.column, "filter", hasInnerNodes);
        if (!value) return passOn(value);
        choice.filter.push_back({*value, range});
    }
    return choice;
}

Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const Style& style, bool hasInnerNodes) {
    auto choice = chooseColumns(facts, style.filter, hasInnerNodes);
    if (!choice || style.color != ColorSource::Column) return choice;
    const auto value = choose(facts, style.column, "color", hasInnerNodes);
    if (!value) return passOn(value);
    choice->color = *value;
    choice->ends = style.range.value_or(naturalEnds(facts, style.column).value_or(std::array{0.0, 1.0}));
    return choice;
}

}  // namespace scancast
