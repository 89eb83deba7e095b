// Which columns of a cloud a view may be coloured and filtered by, and what a view's words mean for one cloud. Plain values;
// any thread. Pipeline: view + facts → **choice** → pictured file.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "protocol/view/view.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Of facts.columns, those that tell more than samples do: not what `ingest --exact` keeps of positions, normals and colours; of
/// several with one name the first.
std::vector<std::size_t> choosableColumns(const CloudFacts& facts);

/// What `filter` may name beside columns.
inline constexpr std::string_view intensityName = "intensity", classificationName = "classification";

/// Where a value is found: in a kept column, or in the sample itself.
enum class ValueFrom : std::uint8_t { Column, Intensity, Classification };

struct ChosenValue {
    ValueFrom from = ValueFrom::Column;
    std::size_t column = 0;  ///< of facts.columns; Column only
};

struct ChosenRange {
    ChosenValue value;
    ColumnRange range;
};

/// What a view asks of a cloud's columns.
struct ColumnChoice {
    std::optional<ChosenValue> color;
    std::array<double, 2> ends{0, 1};  ///< values at the colour map's ends; color only
    std::vector<ChosenRange> filter;

    bool isNothing() const { return !color && filter.empty(); }
    /// The same for the same choice, of one cloud.
    std::string words() const;
};

/// The range that a column - or intensity - is coloured over when nobody says any: where most of its values lie. nullopt: there is none
/// of that name.
std::optional<std::array<double, 2>> naturalEnds(const CloudFacts& facts, std::string_view name);
/// The columns that a view of this cloud file may name: of its points and, where there are any, of its inner nodes.
bool isDrawn(const CloudFacts& facts, const Column& column, bool hasInnerNodes);

/// Errors: Unsupported, with what columns there are, for one that there is not; and for a cloud file without its inner
/// nodes' values, with the way to get them. Field `color` or `filter`.
Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const Style& style, bool hasInnerNodes);
/// Of a filter alone, of leaves alone: what exports need.
Expected<ColumnChoice> chooseColumns(const CloudFacts& facts, const ColumnRanges& filter, bool hasInnerNodes);

}  // namespace scancast
