// The way back: access units, one after the other → pixels. For clients, and for tests of the encoder. Reads what video_encoder.hpp
// writes; whatever else a server might send is refused or decoded, never trusted: sizes are checked against what
// the frame says, and the library's own limit is 36 864 macroblocks.
//
// Owned by whoever shows frames; one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

class VideoDecoder {
  public:
    /// Unavailable where there is no OpenH264.
    static Expected<std::unique_ptr<VideoDecoder>> open();
    virtual ~VideoDecoder() = default;

    /// The picture of the next access unit: `width` · `height` · 3 bytes, red, green, blue, rows from the top. Malformed when it is no picture
    /// of that size (an odd side may be one longer), Truncated when it is damaged or lacks those before it:
    /// then nothing can be decoded before the next key.
    virtual Expected<std::vector<std::uint8_t>> decode(std::span<const std::uint8_t> accessUnit, int width,
                                                       int height) = 0;
};

}  // namespace scancast
