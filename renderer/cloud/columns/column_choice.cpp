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

std::string listOf(const CloudFacts& facts, bool withSamples) {
    std::string list;
    std::size_t count = 0;
    const auto add = [&](std::string_view name) {
        if (++count > mostListed) return;
        if (!list.empty()) list += ", ";
        list += quoteText(name);
    };
    for (const std::size_t c : choosableColumns(facts)) add(facts.columns[c].column.name);
    if (withSamples && hasValue(facts, ValueFrom::Intensity)) add(intensityName);
    if (withSamples && hasValue(facts, ValueFrom::Classification)) add(classificationName);
    if (count > mostListed) list += fmt::format(" and {} more", count - mostListed);
    return list;
}

tl::unexpected<Error> unknown(const CloudFacts& facts, std::string_view name, std::string_view field) {
    const std::string list = listOf(facts, field == "filter");
    std::string message = fmt::format("this cloud keeps no column {}", quoteText(name));
    if (!list.empty()) message += "; there are " + list;
    if (choosableColumns(facts).empty())
        message +=
            "; columns are kept by ingesting the scan with --keep-attributes (scancast ingest SCAN "
            "--keep-attributes -o CLOUD.scan)";
    return fail(ErrorCode::Unsupported, message, std::string(field));
}

Expected<std::size_t> choose(const CloudFacts& facts, std::string_view name, std::string_view field,
                             bool needsInner) {
    const auto found = findColumn(facts, name);
    if (!found) return unknown(facts, name, field);
    const ValuePlane inner = innerPlane(facts.columns[*found].column);
    if (needsInner && std::ranges::find(facts.companions, inner) == facts.companions.end())
        return fail(
            ErrorCode::Unsupported,
            fmt::format("the cloud file keeps column {} of its points, but not of what is drawn from "
                        "afar; ingest the scan again with --keep-attributes to colour and filter by it",
                        quoteText(name)),
            std::string(field));
    return *found;
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

std::string ColumnChoice::words() const {
    std::string text = color ? fmt::format("color {} {:a} {:a}", *color, ends[0], ends[1]) : "";
    for (const ChosenRange& chosen : filter)
        text += fmt::format("; {} {} {} {:a} {} {:a}", int(chosen.from), chosen.column,
                            chosen.range.low.has_value(), chosen.range.low.value_or(0),
                            chosen.range.high.has_value(), chosen.range.high.value_or(0));
    return text;
}

std::array<double, 2> naturalEnds(const KeptColumn& kept) {
    if (kept.usual && kept.usual->at(0) < kept.usual->at(1)) return *kept.usual;
    return kept.range;
}

Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const ColumnRanges& filter,
                                     bool hasInnerNodes) {
    ColumnChoice choice;
    for (const ColumnRange& range : filter) {
        ChosenRange chosen{ValueFrom::Column, 0, range};
        // A kept column of that name goes first: it is what the cloud calls so.
        if (!findColumn(facts, range.column)) {
            if (range.column == intensityName) chosen.from = ValueFrom::Intensity;
            if (range.column == classificationName) chosen.from = ValueFrom::Classification;
        }
        if (chosen.from == ValueFrom::Column) {
            const auto found = choose(facts, range.column, "filter", hasInnerNodes);
            if (!found) return passOn(found);
            chosen.column = *found;
        } else if (!hasValue(facts, chosen.from)) {
            return unknown(facts, range.column, "filter");
        }
        choice.filter.push_back(std::move(chosen));
    }
    return choice;
}

Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const Style& style, bool hasInnerNodes) {
    auto choice = chooseColumns(facts, style.filter, hasInnerNodes);
    if (!choice || style.color != ColorSource::Column) return choice;
    const auto found = choose(facts, style.column, "color", hasInnerNodes);
    if (!found) return passOn(found);
    choice->color = *found;
    choice->ends = style.range.value_or(naturalEnds(facts.columns[*found]));
    return choice;
}

}  // namespace scancast
