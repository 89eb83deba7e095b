// Kept columns on their way out: the number that stands in a row, what it means, and a name for it that every format
// takes. Pure functions. Pipeline: points → **columns** → writers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Numbers with a fixed count of digits behind the point: origin + step * whole number, in units of 10^-digits.
struct DecimalGrid {
    int digits = 0;
    std::int64_t origin = 0, step = 1;
};
/// Nothing where twelve digits do not say both exactly.
std::optional<DecimalGrid> decimalGrid(double origin, double step);

/// A column as it is written.
struct OutColumn {
    std::string name;  ///< letters, digits and _; none twice
    Column column;
    std::size_t at = 0;  ///< its place in a row
    /// Of whole numbers with a decimal scale.
    std::optional<DecimalGrid> decimals{};

    bool scaled() const { return column.scale != 1 || column.offset != 0; }
};
/// All columns of a scan. `taken`: names that something else has already.
std::vector<OutColumn> outColumns(const ScanHeader& header, std::span<const std::string_view> taken);

/// The number stored at `at`, of up to 64 bits: whole numbers beyond 2^53 are rounded.
double storedNumber(const std::byte* at, ColumnType type);
/// The same of a whole number; of floats, what is before the point.
std::int64_t storedWhole(const std::byte* at, ColumnType type);
bool isWhole(ColumnType type);
/// offset + scale * stored number.
double valueOf(const std::byte* row, const OutColumn& column);

}  // namespace scancast
