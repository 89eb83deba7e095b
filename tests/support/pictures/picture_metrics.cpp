#include "tests/support/pictures/picture_metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scancast {
namespace {

constexpr int window = 11, reach = window / 2;

std::size_t pixelsOf(const Frame& frame) {
    return std::size_t(frame.width) * std::size_t(frame.height);
}

bool comparable(const Frame& a, const Frame& b, const PixelMask& mask) {
    return a.width == b.width && a.height == b.height && a.width > 0 && a.height > 0 &&
           a.rgba.size() == pixelsOf(a) * 4 && b.rgba.size() == pixelsOf(b) * 4 &&
           (mask.empty() || mask.size() == pixelsOf(a));
}

std::vector<double> lumaOf(const Frame& frame) {
    std::vector<double> luma(pixelsOf(frame));
    for (std::size_t i = 0; i < luma.size(); ++i)
        luma[i] = 0.299 * frame.rgba[4 * i] + 0.587 * frame.rgba[4 * i + 1] + 0.114 * frame.rgba[4 * i + 2];
    return luma;
}

std::array<double, window> gaussian() {
    std::array<double, window> weights{};
    double sum = 0;
    for (int i = 0; i < window; ++i) {
        const double off = i - reach;
        weights[std::size_t(i)] = std::exp(-off * off / (2 * 1.5 * 1.5));
        sum += weights[std::size_t(i)];
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// Weighted means over all windows; only those that lie wholly in the picture are filled in.
std::vector<double> blurred(const std::vector<double>& values, int width, int height) {
    static const std::array<double, window> weights = gaussian();
    std::vector<double> across(values.size()), both(values.size());
    const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
    for (int y = 0; y < height; ++y)
        for (int x = reach; x < width - reach; ++x)
            for (int i = 0; i < window; ++i)
                across[at(x, y)] += weights[std::size_t(i)] * values[at(x + i - reach, y)];
    for (int y = reach; y < height - reach; ++y)
        for (int i = 0; i < window; ++i)
            for (int x = reach; x < width - reach; ++x)
                both[at(x, y)] += weights[std::size_t(i)] * across[at(x, y + i - reach)];
    return both;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size());
    std::ranges::transform(a, b, result.begin(), [](double x, double y) { return x * y; });
    return result;
}

}  // namespace

std::optional<double> psnr(const Frame& picture, const Frame& truth, const PixelMask& mask) {
    if (!comparable(picture, truth, mask)) return std::nullopt;
    std::uint64_t sum = 0, counted = 0;
    for (std::size_t i = 0; i < pixelsOf(picture); ++i) {
        if (!mask.empty() && mask[i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const int off = int(picture.rgba[4 * i + c]) - int(truth.rgba[4 * i + c]);
            sum += std::uint64_t(off * off);
        }
        counted += 3;
    }
    if (counted == 0) return std::nullopt;
    if (sum == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(255.0 * 255.0 * double(counted) / double(sum));
}

std::optional<double> ssim(const Frame& picture, const Frame& truth, const PixelMask& mask) {
    if (!comparable(picture, truth, mask)) return std::nullopt;
    const int width = picture.width, height = picture.height;
    const std::vector<double> x = lumaOf(picture), y = lumaOf(truth);
    const auto meanX = blurred(x, width, height), meanY = blurred(y, width, height),
               meanXX = blurred(product(x, x), width, height), meanYY = blurred(product(y, y), width, height),
               meanXY = blurred(product(x, y), width, height);
    constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
    double sum = 0;
    std::uint64_t counted = 0;
    for (int row = reach; row < height - reach; ++row) {
        for (int column = reach; column < width - reach; ++column) {
            const std::size_t i = std::size_t(row) * std::size_t(width) + std::size_t(column);
            if (!mask.empty() && mask[i] == 0) continue;
            const double mx = meanX[i], my = meanY[i], xx = meanXX[i] - mx * mx, yy = meanYY[i] - my * my,
                         xy = meanXY[i] - mx * my;
            sum += (2 * mx * my + c1) * (2 * xy + c2) / ((mx * mx + my * my + c1) * (xx + yy + c2));
            ++counted;
        }
    }
    return counted > 0 ? std::optional(sum / double(counted)) : std::nullopt;
}

std::optional<double> changedPixels(const Frame& before, const Frame& after, int threshold,
                                    const PixelMask& mask) {
    if (!comparable(before, after, mask)) return std::nullopt;
    std::uint64_t changed = 0, counted = 0;
    for (std::size_t i = 0; i < pixelsOf(before); ++i) {
        if (!mask.empty() && mask[i] == 0) continue;
        bool differs = false;
        for (std::size_t c = 0; c < 3; ++c)
            differs |= std::abs(int(before.rgba[4 * i + c]) - int(after.rgba[4 * i + c])) > threshold;
        changed += differs;
        ++counted;
    }
    return counted > 0 ? std::optional(double(changed) / double(counted)) : std::nullopt;
}

PixelMask eroded(const PixelMask& mask, int width, int height, int radius) {
    // A square is a run across, then a run down.
    const auto pass = [&](const PixelMask& from, int length, int lines, std::size_t step,
                          std::size_t lineStep) {
        PixelMask to(from.size());
        for (int line = 0; line < lines; ++line) {
            const std::size_t first = std::size_t(line) * lineStep;
            for (int i = 0; i < length; ++i) {
                const int low = std::max(0, i - radius), high = std::min(length - 1, i + radius);
                bool all = true;
                for (int k = low; k <= high && all; ++k) all = from[first + std::size_t(k) * step] != 0;
                to[first + std::size_t(i) * step] = all;
            }
        }
        return to;
    };
    if (width < 1 || height < 1 || mask.size() != std::size_t(width) * std::size_t(height)) return {};
    return pass(pass(mask, width, height, 1, std::size_t(width)), height, width, std::size_t(width), 1);
}

std::optional<Holes> countHoles(const Frame& picture, const PixelMask& silhouette, int erosion) {
    const std::size_t pixels = pixelsOf(picture);
    if (pixels == 0 || picture.depth.size() != pixels || silhouette.size() != pixels) return std::nullopt;
    const PixelMask inside = eroded(silhouette, picture.width, picture.height, erosion);
    Holes holes;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (inside[i] == 0) continue;
        ++holes.counted;
        holes.pixels += std::isinf(picture.depth[i]);
    }
    return holes;
}

}  // namespace scancast
