// What a JPEG says about itself: size, quality, resolution of colours. A pure function; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "protocol/error.hpp"

namespace scancast::client {

struct JpegFacts {
    int width = 0, height = 0;
    int quality = 0;  ///< 1-100: the one whose standard table of luminance is nearest to this picture's
    std::string subsampling;  ///< "4:2:0", "4:2:2", "4:4:4"; else the factors: "4x1"
};

/// Reads markers only. Truncated or Malformed for what is no baseline or progressive JPEG.
Expected<JpegFacts> jpegFacts(std::span<const std::uint8_t> bytes);

}  // namespace scancast::client
