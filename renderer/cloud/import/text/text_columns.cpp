#include "renderer/cloud/import/text/text_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/text/text_names.hpp"

namespace scancast {

namespace {

/// The numbers of the lines that were looked at, by column; fields that are no numbers are remembered.
struct Table {
    std::size_t columns = 0;
    std::vector<double> values;  ///< row after row
    std::vector<SeenValues> seen;
    std::vector<bool> numeric;

    std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
    SeenValues seenIn(std::size_t first, std::size_t count) const {
        SeenValues all;
        for (std::size_t c = first; c < first + count; ++c) all.see(seen[c]);
        return all;
    }
};

/// Lines with another number of fields are left to the reader, which names them.
Table tabulate(std::span<const std::string_view> lines, Separator separator, std::size_t columns) {
    Table table{columns, {}, std::vector<SeenValues>(columns), std::vector<bool>(columns, true)};
    std::vector<std::string_view> fields;
    for (const auto line : lines) {
        if (isComment(line)) continue;
        splitFields(line, separator, fields);
        if (fields.size() != columns) continue;
        for (std::size_t c = 0; c < columns; ++c) {
            const auto number = numberIn(fields[c], separator.decimalComma);
            if (!number) table.numeric[c] = false;
            const double value = number.value_or(0);
            table.values.push_back(value);
            table.seen[c].see(value, fields[c].find_first_of(".,eE") != fields[c].npos);
        }
    }
    return table;
}

/// Three columns of unit vectors. Up to a hundredth of them may be something else: 0, where a program found
/// no normal.
bool areNormals(const Table& table, std::size_t first) {
    const auto range = table.seenIn(first, 3);
    if (!range.within(-1.001, 1.001) || !range.fractions) return false;
    std::size_t units = 0;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const auto* n = table.values.data() + row * table.columns + first;
        units += std::abs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 0.02;
    }
    return units * 100 >= table.rows() * 99;
}

/// Without names, 51200.000 may be anything.
bool areColors(const Table& table, std::size_t first) {
    const auto seen = table.seenIn(first, 3);
    const auto scale = colorScale(seen);
    return scale && (*scale != ColorScale::Word || !seen.fractions);
}

/// What may stand behind x, y and z in a text without names: i intensity, c three of colour, n three of
/// normal. The first that fits is taken; normals come first, they are the harder to mistake.
constexpr std::string_view orders[] = {"",   "i",  "n",  "c",   "in",  "ni",  "ic",
                                       "ci", "nc", "cn", "icn", "inc", "cin", "cni"};

std::size_t width(std::string_view order) {
    std::size_t columns = 3;
    for (const char c : order) columns += c == 'i' ? 1 : 3;
    return columns;
}

bool fits(const Table& table, std::string_view order) {
    if (width(order) != table.columns) return false;
    std::size_t at = 3;
    for (const char c : order) {
        if (c == 'n' && !areNormals(table, at)) return false;
        if (c == 'c' && !areColors(table, at)) return false;
        at += c == 'i' ? 1 : 3;
    }
    return true;
}

std::array<int, 3> three(int first) {
    return {first, first + 1, first + 2};
}

void guessByValues(const Table& table, TextLayout& layout) {
    layout.position = {0, 1, 2};
    const auto* order =
        std::find_if(std::begin(orders), std::end(orders), [&](auto o) { return fits(table, o); });
    if (order == std::end(orders)) return;
    int at = 3;
    for (const char c : *order) {
        if (c == 'i') layout.intensity = at;
        if (c == 'c') layout.color = three(at);
        if (c == 'n') layout.normal = three(at);
        at += c == 'i' ? 1 : 3;
    }
}

/// Colours of which one is missing are none, and so on: half a triple says nothing.
void dropHalf(std::array<int, 3>& triple) {
    if (std::find(triple.begin(), triple.end(), TextLayout::none) != triple.end())
        triple.fill(TextLayout::none);
}

bool uses(const TextLayout& layout, int column) {
    const auto in = [&](const std::array<int, 3>& triple) {
        return std::find(triple.begin(), triple.end(), column) != triple.end();
    };
    return in(layout.position) || in(layout.color) || in(layout.normal) || layout.intensity == column ||
           layout.classification == column;
}

SeenValues seenColors(const Table& table, const TextLayout& layout) {
    SeenValues all;
    for (const int c : layout.color) all.see(table.seen[static_cast<std::size_t>(c)]);
    return all;
}

/// A comment that names columns is believed only as far as it fits; a header line has to fit.
Expected<void> assign(const TextHead& head, const Table& table, const std::string& name, TextLayout& layout) {
    const bool fitting = head.names.size() == layout.columns;
    if (head.names.empty() || (head.namesInComment && !fitting)) {
        guessByValues(table, layout);
        return {};
    }
    const auto place = fmt::format("{}, line {}: ", name, grouped(head.namesLine));
    if (!fitting)
        return fail(ErrorCode::Malformed, fmt::format("{}{} columns are named, but the first point has {}",
                                                      place, head.names.size(), layout.columns));
    if (auto ok = assignByNames(head.names, layout); !ok)
        return fail(ok.error().code, place + ok.error().message);
    layout.names = head.names;
    dropHalf(layout.color);
    dropHalf(layout.normal);
    return {};
}

Expected<void> judgeValues(const Table& table, bool pts, const std::string& name, TextLayout& layout) {
    if (layout.color[0] != TextLayout::none) {
        const auto seen = seenColors(table, layout);
        const auto scale = colorScale(seen);
        if (!scale)
            return fail(ErrorCode::Malformed,
                        fmt::format("{}: the columns red, green and blue hold numbers from {:f} to {:f}; "
                                    "colours are 0 to 255, 0 to 65535 or 0 to 1",
                                    name, seen.least, seen.most));
        layout.colorScale = *scale;
    }
    if (layout.intensity != TextLayout::none)
        layout.intensityScale = intensityScale(table.seen[static_cast<std::size_t>(layout.intensity)], pts);
    for (int c = 0; c < static_cast<int>(layout.columns); ++c)
        if (!uses(layout, c) && table.numeric[static_cast<std::size_t>(c)]) layout.spare.push_back(c);
    return {};
}

}  // namespace

std::string TextLayout::describe() const {
    std::vector<std::string> words(columns, "-");
    const auto set = [&](int column, const char* word) {
        if (column != none) words[static_cast<std::size_t>(column)] = word;
    };
    static constexpr const char* axes[] = {"x", "y", "z"};
    static constexpr const char* colors[] = {"red", "green", "blue"};
    static constexpr const char* normals[] = {"nx", "ny", "nz"};
    for (std::size_t i = 0; i < 3; ++i) {
        set(position[i], axes[i]);
        set(color[i], colors[i]);
        set(normal[i], normals[i]);
    }
    set(intensity, "intensity");
    set(classification, "classification");
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

Expected<TextLayout> understandColumns(const TextHead& head, std::span<const std::string_view> lines,
                                       bool pts, const std::string& name) {
    const auto place = fmt::format("{}, line {}: ", name, grouped(head.lines + 1));
    std::vector<std::string_view> points;
    for (const auto line : lines)
        if (!isComment(line)) points.push_back(line);
    if (points.empty()) return fail(ErrorCode::Empty, name + " is a text without points");

    TextLayout layout;
    layout.separator = separatorOf(points);
    std::vector<std::string_view> fields;
    splitFields(points.front(), layout.separator, fields);
    layout.columns = fields.size();
    if (layout.columns < 3)
        return fail(
            ErrorCode::Malformed,
            fmt::format("{}there are {} columns; a point needs at least x, y and z", place, layout.columns));
    if (layout.columns > mostTextColumns)
        return fail(ErrorCode::Malformed, fmt::format("{}there are {} columns; at most {} are read", place,
                                                      grouped(layout.columns), mostTextColumns));
    const auto table = tabulate(points, layout.separator, layout.columns);
    if (auto ok = assign(head, table, name, layout); !ok) return passOn(ok);
    if (auto ok = judgeValues(table, pts, name, layout); !ok) return passOn(ok);
    return layout;
}

}  // namespace scancast
