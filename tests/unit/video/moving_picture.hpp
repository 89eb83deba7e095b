// A picture that moves a little from frame to frame, and how far two pictures are apart.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace scancast::test {

/// RGBA: a landscape of waves, `shift` px further to the left.
inline std::vector<std::uint8_t> waves(int width, int height, int shift) {
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = x + shift;
            rgba.push_back(std::uint8_t(128 + 90 * std::sin(u / 17) * std::cos(y / 23.0)));
            rgba.push_back(std::uint8_t(128 + 90 * std::sin((u + 2 * y) / 31)));
            rgba.push_back(std::uint8_t(128 + 60 * std::cos(u / 11 - y / 19.0)));
            rgba.push_back(255);
        }
    return rgba;
}

/// Of RGBA against RGB, dB.
inline double psnr(std::span<const std::uint8_t> rgba, std::span<const std::uint8_t> rgb) {
    double sum = 0;
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const double difference = double(rgba[i / 3 * 4 + i % 3]) - rgb[i];
        sum += difference * difference;
    }
    return 10 * std::log10(255.0 * 255.0 * double(rgb.size()) / sum);
}

}  // namespace scancast::test
