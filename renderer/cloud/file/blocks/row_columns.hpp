// Rows of kept columns taken apart into the columns' values, and put together again. Pure functions.
// Pipeline: kept rows → **columns** → planes of a cloud file, and back.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Where a column's values stand in a row.
struct PlaceInRow {
    std::size_t offset, bytes, rowBytes;
};

/// One for each column, packed in their order.
std::vector<PlaceInRow> placesInRow(std::span<const ColumnType> columns);

/// One column's values, packed.
std::vector<std::byte> takeColumn(std::span<const std::byte> rows, const PlaceInRow& place);
/// The inverse: as many values as `rows` has rows.
void putColumn(std::span<const std::byte> values, const PlaceInRow& place, std::span<std::byte> rows);

}  // namespace scancast
