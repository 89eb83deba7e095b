// How far two devices' pictures of the same thing are apart.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "renderer/image/frame.hpp"

namespace scancast::test {

struct Agreement {
    double psnr = std::numeric_limits<double>::infinity();  ///< dB, of all four channels
    std::size_t pixels = 0;
    std::size_t changed = 0;       ///< pixels of which a byte differs
    std::size_t changedDepth = 0;  ///< pixels of which the depth's bits differ
    std::size_t covered = 0;       ///< pixels that show a sample, first picture
    int largest = 0;               ///< difference of a channel, of 255

    bool identical() const { return changed == 0 && changedDepth == 0; }
    double part(std::size_t count) const { return pixels == 0 ? 0 : double(count) / double(pixels); }
};

/// Pictures of one size.
inline Agreement agreementOf(const Frame& a, const Frame& b) {
    Agreement result;
    result.pixels = a.depth.size();
    double squares = 0;
    for (std::size_t i = 0; i < result.pixels; ++i) {
        int most = 0;
        for (std::size_t c = 4 * i; c < 4 * i + 4; ++c) {
            const int difference = std::abs(int(a.rgba[c]) - int(b.rgba[c]));
            squares += difference * difference;
            most = std::max(most, difference);
        }
        result.changed += most > 0;
        result.largest = std::max(result.largest, most);
        result.changedDepth += a.depth[i] != b.depth[i];
        result.covered += std::isfinite(a.depth[i]);
    }
    if (squares > 0) result.psnr = 10 * std::log10(255.0 * 255.0 * 4 * double(result.pixels) / squares);
    return result;
}

}  // namespace scancast::test
