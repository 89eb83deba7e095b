// CRC-32C (Castagnoli): what each page of an E57 file ends with. Pure functions.
// Pipeline: file → **pages** → sections → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace scancast::import_e57 {

/// By the processor's instruction where it has one (SSE4.2), else by table.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// The same number on any processor, slower.
std::uint32_t crc32cByTable(std::span<const std::byte> bytes);

}  // namespace scancast::import_e57
