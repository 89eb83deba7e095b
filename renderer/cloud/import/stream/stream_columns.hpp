// The point stream's list of further columns: what every row behind a chunk's own columns holds, as JSON.
// Pure functions. Pipeline: importer process → **point stream** → points.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::point_stream {

inline constexpr std::size_t longestColumns = 262144;  ///< bytes of the list
inline constexpr std::size_t mostColumns = 512;
inline constexpr std::size_t longestColumnName = 64;
inline constexpr std::size_t longestColumnText = 256;

/// Empty for no columns.
std::string encodeColumns(std::span<const Column> columns);

/// Trusts nothing in it. Errors: Importer, without a file's name.
Expected<std::vector<Column>> decodeColumns(std::string_view text);

}  // namespace scancast::point_stream
