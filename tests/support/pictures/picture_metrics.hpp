// How far a picture is from the truth: PSNR, SSIM, changed pixels, holes. Pure functions; any thread. For the
// table of methods and for tests; colours only, alpha is ignored.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "renderer/image/frame.hpp"

namespace scancast {

/// One entry a pixel, row 0 first; not 0 = counted. An empty mask counts all pixels.
using PixelMask = std::vector<std::uint8_t>;

/// Peak signal-to-noise ratio of R, G and B together, in dB: 10 log10(255² / mean squared difference).
/// +infinity for equal pictures. Nothing when the sizes differ or no pixel is counted.
std::optional<double> psnr(const Frame& picture, const Frame& truth, const PixelMask& mask = {});

/// Structural similarity of luma, as in Wang et al.,
/// "Image Quality Assessment: From Error Visibility to Structural Similarity", 2004, §III: mean over all 11 x
/// 11 windows (Gaussian, sigma 1.5) that lie wholly in the picture, K1 = 0.01, K2 = 0.03. 1 for equal
/// pictures. With a mask, windows whose middle is counted. Nothing when the sizes differ or no window is
/// left.
std::optional<double> ssim(const Frame& picture, const Frame& truth, const PixelMask& mask = {});

/// Part of the pixels of which a channel differs by more than `threshold` of 255. Nothing as for psnr.
std::optional<double> changedPixels(const Frame& before, const Frame& after, int threshold,
                                    const PixelMask& mask = {});

struct Holes {
    std::uint64_t pixels = 0;   ///< background inside the silhouette
    std::uint64_t counted = 0;  ///< pixels of the silhouette, eroded
    double part() const { return counted > 0 ? double(pixels) / double(counted) : 0; }
};

/// Pixels whose depth is infinite though the silhouette, made smaller by `erosion` px all around, says that
/// there is something. Nothing when the sizes differ or the picture has no depth.
std::optional<Holes> countHoles(const Frame& picture, const PixelMask& silhouette, int erosion);

/// What is left of a mask after taking away everything within `radius` px (a square) of an uncounted pixel.
/// Beyond the picture's border nothing is known, which takes nothing away.
PixelMask eroded(const PixelMask& mask, int width, int height, int radius);

}  // namespace scancast
