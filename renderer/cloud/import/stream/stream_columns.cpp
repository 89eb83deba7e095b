#include "renderer/cloud/import/stream/stream_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::point_stream {

namespace {

using nlohmann::json;

constexpr ColumnType types[] = {
    ColumnType::Int8,   ColumnType::Uint8, ColumnType::Int16,  ColumnType::Uint16,  ColumnType::Int32,
    ColumnType::Uint32, ColumnType::Int64, ColumnType::Uint64, ColumnType::Float32, ColumnType::Float64};

tl::unexpected<Error> wrongColumn(std::size_t index, const std::string& reason) {
    return fail(ErrorCode::Importer, fmt::format("its point stream's column {} is wrong: {}", index, reason));
}

/// A text of the JSON object, printable; empty if it is not there.
std::string textOf(const json& object, const char* key, std::size_t longest) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) return {};
    return printableText(found->get_ref<const std::string&>(), longest);
}

/// NaN for what is no number; `otherwise` for what is not there.
double numberOf(const json& object, const char* key, double otherwise) {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    return found->is_number() ? found->get<double>() : std::nan("");
}

Expected<Column> decodeColumn(const json& object, std::size_t index) {
    if (!object.is_object()) return wrongColumn(index, "it is no JSON object");
    Column column;
    column.name = textOf(object, "name", longestColumnName);
    column.description = textOf(object, "description", longestColumnText);
    if (column.name.empty()) return wrongColumn(index, "it has no name");
    const auto typeName = textOf(object, "type", 16);
    const auto* type =
        std::find_if(std::begin(types), std::end(types), [&](ColumnType t) { return name(t) == typeName; });
    if (type == std::end(types)) return wrongColumn(index, "its type \"" + typeName + "\" is not known");
    column.type = *type;
    column.scale = numberOf(object, "scale", 1);
    column.offset = numberOf(object, "offset", 0);
    if (!std::isfinite(column.scale) || column.scale == 0 || !std::isfinite(column.offset))
        return wrongColumn(index, "its scale or offset is not a number");
    return column;
}

}  // namespace

std::string encodeColumns(std::span<const Column> columns) {
    if (columns.empty()) return {};
    auto list = json::array();
    for (const auto& column : columns)
        list.push_back({{"name", printableText(column.name, longestColumnName)},
                        {"type", name(column.type)},
                        {"scale", column.scale},
                        {"offset", column.offset},
                        {"description", printableText(column.description, longestColumnText)}});
    return list.dump();
}

Expected<std::vector<Column>> decodeColumns(std::string_view text) {
    const auto list = json::parse(text, nullptr, false);
    if (!list.is_array() || list.empty() || list.size() > mostColumns)
        return fail(ErrorCode::Importer,
                    fmt::format("its point stream's list of columns is no JSON list of 1 to {} columns",
                                mostColumns));
    std::vector<Column> columns;
    std::set<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
        auto column = decodeColumn(list[i], i);
        if (!column) return passOn(column);
        if (!names.insert(column->name).second)
            return wrongColumn(i, "another one is called \"" + column->name + "\"");
        columns.push_back(std::move(*column));
    }
    return columns;
}

}  // namespace scancast::point_stream
