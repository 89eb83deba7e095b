#include "renderer/cloud/import/text/text_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

bool isLongerBy(const glm::vec3& normal) {
    return std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z) &&
           glm::dot(normal, normal) > 1e-20F;
}

}  // namespace

TextRow::TextRow(TextLayout layout, bool keep)
    : layout_(std::move(layout)),
      keep_(keep),
      // Without names every column has to be a number: what else could it be?
      wanted_(layout_.columns, layout_.names.empty() ? 1 : 0),
      values_(layout_.columns) {
    const auto want = [&](int column) {
        if (column != TextLayout::none) wanted_[static_cast<std::size_t>(column)] = 1;
    };
    for (std::size_t i = 0; i < 3; ++i) {
        want(layout_.position[i]);
        want(layout_.color[i]);
        want(layout_.normal[i]);
    }
    want(layout_.intensity);
    want(layout_.classification);
    if (keep_)
        for (const int column : layout_.spare) want(column);
}

const std::string* TextRow::parse(std::string_view line) {
    if (layout_.separator.decimalComma) {
        comma_.assign(line);
        std::replace(comma_.begin(), comma_.end(), ',', '.');
        line = comma_;
    }
    const char mark = layout_.separator.mark;
    const char* const end = line.data() + line.size();
    const char* at = skipBlanks(line.data(), end);
    for (std::size_t c = 0; c < layout_.columns; ++c) {
        if (at == end) return badCount(line);
        const char* const from = at;
        if (!wanted_[c]) {
            at = mark == ' ' ? std::find_if(at, end, isBlank) : std::find(at, end, mark);
        } else {
            const bool quoted = *at == '"';
            at += quoted;
            if (!readNumber(at, end, values_[c])) return badField(c, from, end);
            if (quoted && (at == end || *at++ != '"')) return badField(c, from, end);
        }
        const char* const behind = at;
        at = skipBlanks(at, end);
        if (at == end) continue;
        if (mark == ' ') {
            if (at == behind) return badField(c, from, end);
        } else {
            if (*at != mark) return badField(c, from, end);
            at = skipBlanks(at + 1, end);
        }
    }
    if (at != end) return badCount(line);
    position_ = {value(layout_.position[0]), value(layout_.position[1]), value(layout_.position[2])};
    return nullptr;
}

bool TextRow::finite() const {
    return std::isfinite(position_.x) && std::isfinite(position_.y) && std::isfinite(position_.z);
}

const std::string* TextRow::appendTo(PointBatch& batch, const glm::dvec3& position) {
    if (layout_.color[0] != TextLayout::none) {
        std::array<std::uint8_t, 3> color{};
        for (std::size_t i = 0; i < 3; ++i)
            if (!toColor(value(layout_.color[i]), layout_.colorScale, color[i]))
                return badColor(layout_.color[i]);
        batch.color.push_back(color);
    }
    if (layout_.classification != TextLayout::none) {
        const double number = value(layout_.classification);
        if (!(number >= 0 && number <= 255)) {
            why_ = fmt::format("the class {:f} is not 0 to 255", number);
            return &why_;
        }
        batch.classification.push_back(static_cast<std::uint8_t>(number));
    }
    batch.position.push_back(position);
    if (layout_.intensity != TextLayout::none)
        batch.intensity.push_back(toIntensity(value(layout_.intensity), layout_.intensityScale));
    if (layout_.normal[0] != TextLayout::none) {
        const glm::vec3 normal(value(layout_.normal[0]), value(layout_.normal[1]), value(layout_.normal[2]));
        batch.normal.push_back(isLongerBy(normal) ? glm::normalize(normal) : glm::vec3(0));
    }
    if (keep_) {
        auto at = batch.rows.size();
        batch.rows.resize(at + layout_.spare.size() * sizeof(double));
        for (const int column : layout_.spare) {
            std::memcpy(batch.rows.data() + at, &values_[static_cast<std::size_t>(column)], sizeof(double));
            at += sizeof(double);
        }
    }
    return nullptr;
}

const std::string* TextRow::badField(std::size_t column, const char* at, const char* end) {
    const char mark = layout_.separator.mark;
    const auto* to = mark == ' ' ? std::find_if(at, end, isBlank) : std::find(at, end, mark);
    const auto field = quotedText({at, static_cast<std::size_t>(to - at)});
    why_ = at == to ? fmt::format("column {} is empty", column + 1)
                    : fmt::format("column {}: {} is not a number", column + 1, field);
    return &why_;
}

const std::string* TextRow::badCount(std::string_view line) {
    std::vector<std::string_view> fields;
    splitFields(line, layout_.separator, fields);
    why_ = fmt::format("there are {} columns, but {} on the lines before", grouped(fields.size()),
                       layout_.columns);
    return &why_;
}

const std::string* TextRow::badColor(int column) {
    static constexpr const char* ranges[] = {"0 to 255", "0 to 65535", "0 to 1"};
    const double number = value(column);
    std::array<char, 32> text{};
    const auto written = std::to_chars(text.data(), text.data() + text.size(), number);
    why_ = fmt::format(
        "column {}: the colour {} is outside of {}, the range that the file's other colours have", column + 1,
        std::string_view(text.data(), written.ptr), ranges[static_cast<std::size_t>(layout_.colorScale)]);
    return &why_;
}

std::vector<Column> keptTextColumns(const TextLayout& layout) {
    std::vector<Column> columns;
    for (const int c : layout.spare) {
        Column column;
        column.name = layout.names.empty() ? "column_" + std::to_string(c + 1)
                                           : layout.names[static_cast<std::size_t>(c)];
        columns.push_back(std::move(column));
    }
    return columns;
}

}  // namespace scancast
