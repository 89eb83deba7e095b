// Pictures to bytes: JPEG by TurboJPEG, PNG by libspng. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "protocol/view/view.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

using Bytes = std::vector<std::uint8_t>;

/// Baseline JPEG; alpha is dropped. Same frame, quality and subsampling → same bytes, on any number of `threads` (0 = all cores): each
/// encodes stripes of jpegStripeRows (jpeg_stripes.hpp), whose height depends on nothing, with a restart marker between them.
Expected<Bytes> encodeJpeg(const Frame& frame, int quality, Subsampling subsampling, int threads = 1);
/// 8-bit PNG; RGBA when `alpha`, else RGB. Looks at `stop` with every row, because large ones take seconds:
/// Cancelled.
Expected<Bytes> encodePng(const Frame& frame, bool alpha, const std::stop_token& stop = {});

/// For tests and clients: RGBA, no depth. Malformed or Truncated with the library's reason.
Expected<Frame> decodeJpeg(std::span<const std::uint8_t> bytes);
Expected<Frame> decodePng(std::span<const std::uint8_t> bytes);

}  // namespace scancast
