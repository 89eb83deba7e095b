// The public header block of LAS (ASPRS LAS 1.4 R15, table 3), as far as taking a file apart needs it; what is refused is refused in the words of
// renderer/cloud/import/las/las_header.cpp. Pure functions on bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/error.hpp"

namespace scancast::laz {

/// What of the public header block this room goes by.
struct LasShape {
    int minorVersion = 0;
    int pointFormat = 0;  ///< 0-10
    std::uint32_t headerBytes = 0;
    std::uint64_t pointOffset = 0;
    std::uint32_t recordBytes = 0;  ///< of one record, extra bytes included
    std::uint64_t points = 0;       ///< ≥ 1
    std::uint32_t vlrs = 0;
    std::uint64_t evlrOffset = 0;
    std::uint32_t evlrs = 0;
    bool compressed = true;  ///< false: LAS
};

/// Of the longest version.
inline constexpr std::size_t longestLasHeader = 375;

/// `bytes`: the first of the file, up to longestLasHeader. Errors: Malformed, Truncated, Unsupported, Empty.
Expected<LasShape> parseLasShape(std::span<const std::byte> bytes);

}  // namespace scancast::laz
