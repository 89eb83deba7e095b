#include "renderer/cloud/file/blocks/row_columns.hpp"

#include <cstring>

namespace scancast {

std::vector<PlaceInRow> placesInRow(std::span<const ColumnType> columns) {
    std::vector<PlaceInRow> places;
    std::size_t end = 0;
    for (const ColumnType type : columns) {
        places.push_back({.offset = end, .bytes = bytesOf(type), .rowBytes = 0});
        end += bytesOf(type);
    }
    for (PlaceInRow& place : places) place.rowBytes = end;
    return places;
}

std::vector<std::byte> takeColumn(std::span<const std::byte> rows, const PlaceInRow& place) {
    const std::size_t count = rows.size() / place.rowBytes;
    std::vector<std::byte> values(count * place.bytes);
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(&values[i * place.bytes], &rows[i * place.rowBytes + place.offset], place.bytes);
    return values;
}

void putColumn(std::span<const std::byte> values, const PlaceInRow& place, std::span<std::byte> rows) {
    const std::size_t count = rows.size() / place.rowBytes;
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(&rows[i * place.rowBytes + place.offset], &values[i * place.bytes], place.bytes);
}

}  // namespace scancast
