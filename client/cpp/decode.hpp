// A frame's JPEG as pixels. A pure function; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast::client {

struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  ///< 3 bytes a pixel, rows from the top without gaps
};

/// Malformed or Truncated, with the decoder's reason; ResourceLimit for more than `mostPixels`, of which no memory is taken:
/// a JPEG of a few bytes can promise a picture of 800 MB.
Expected<Pixels> decodeJpeg(std::span<const std::uint8_t> jpeg,
                            std::size_t mostPixels = std::size_t{16384} * 16384);

}  // namespace scancast::client
