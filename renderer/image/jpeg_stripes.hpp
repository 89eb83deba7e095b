// Pictures that were encoded in stripes, joined into one. Baseline JPEG, ITU-T T.81: a restart marker (section B.2.1) aligns the scan
// to a byte and sets its predictions back, which is what the beginning of a picture does (F.1.1.5.1); so the scans of stripes, each
// encoded as a picture of its own, are the scan of the whole. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// Rows of a stripe: whole blocks of any subsampling; few enough for as many stripes as a machine has cores, many enough that markers
/// and tables of their own cost nothing.
inline constexpr int jpegStripeRows = 64;

/// `stripes`: at least one, from the top; baseline, of one width, one quality and one subsampling, as TurboJPEG writes them; each of
/// `rows` rows, a multiple of 16, but the last, which has what is left of `height`. Internal where they are not.
Expected<std::vector<std::uint8_t>> joinJpegStripes(std::span<const std::span<const std::uint8_t>> stripes,
                                                    int height, int rows);

}  // namespace scancast
