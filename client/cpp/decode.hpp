// A frame's JPEG as pixels. A pure function; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast::client {

struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  ///< 3 bytes a pixel, rows from the top without gaps
};

/// Malformed or Truncated, with the decoder's reason.
Expected<Pixels> decodeJpeg(std::span<const std::uint8_t> jpeg);

}  // namespace scancast::client
