// Rows of numbers, all of the same length: how the binary bodies of PLY and PCD hold points. Read here, a slice at a time; PCL's
// readers call a function for each number, or look at each for NaN, which takes several times as long
// (docs/decisions/014-pcl-reads-and-does-not-estimate.md). Used on one thread. Pipeline: header → **rows** → raw points → columns.
#pragma once

#include <functional>
#include <istream>
#include <vector>

#include "importers/pcl/point_fields.hpp"
#include "protocol/error.hpp"

namespace scancast::import_pcl {

using RawPointSink = std::function<Expected<void>(const RawPoint&)>;

/// A number of a row that is read; numbers that mean nothing here are passed over.
struct RowField {
    std::uint32_t offset = 0;  ///< bytes, from the row's beginning
    ColumnType type = ColumnType::Float32;
    Meaning meaning = Meaning::X;
};

struct RowLayout {
    std::uint32_t bytes = 0;  ///< of a row; above 0, and no field reaches beyond
    bool bigEndian = false;
    std::vector<RowField> fields;
};

/// Packed colours come as the value of their bits, whatever type hides them.
void readRow(const std::byte* row, const RowLayout& layout, RawPoint& into);

/// Calls `sink` for each of `count` rows, from where `stream` stands. How many there were: fewer only where the stream ends.
/// Errors: the sink's.
Expected<std::uint64_t> readRows(std::istream& stream, const RowLayout& layout, std::uint64_t count,
                                 const RawPointSink& sink);

}  // namespace scancast::import_pcl
