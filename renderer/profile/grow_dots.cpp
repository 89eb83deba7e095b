#include "renderer/profile/grow_dots.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scancast {
namespace {

/// The picture's rows around one, as they were before anything grew: squares are written into the picture itself.
class RowsBefore {
  public:
    RowsBefore(const std::vector<std::uint64_t>& pixels, int width, int reach)
        : pixels_(pixels),
          width_(width),
          height_(int(pixels.size() / std::size_t(width))),
          reach_(reach),
          rows_(std::size_t(2 * reach + 1) * std::size_t(width)) {
        for (int y = 0; y < std::min(reach, height_); ++y) keep(y);
    }
    /// `y` one after the other; its squares reach no farther down than what is kept here.
    void moveTo(int y) {
        if (y + reach_ < height_) keep(y + reach_);
    }
    std::uint64_t at(int x, int y) const { return rows_[start(y) + std::size_t(x)]; }
    bool isThere(int x, int y) const {
        return x >= 0 && x < width_ && y >= 0 && y < height_ && at(x, y) != 0;
    }
    /// How many of the pixels so far away are there.
    int countAround(int x, int y, int away) const {
        int count = 0;
        for (int i = -away; i <= away; ++i) count += isThere(x + i, y - away) + isThere(x + i, y + away);
        for (int i = 1 - away; i < away; ++i) count += isThere(x - away, y + i) + isThere(x + away, y + i);
        return count;
    }

  private:
    std::size_t start(int y) const { return std::size_t(y % (2 * reach_ + 1)) * std::size_t(width_); }
    void keep(int y) {
        const auto from = pixels_.begin() + std::ptrdiff_t(y) * width_;
        std::copy(from, from + width_, rows_.begin() + std::ptrdiff_t(start(y)));
    }

    const std::vector<std::uint64_t>& pixels_;
    const int width_, height_, reach_;
    std::vector<std::uint64_t> rows_;
};

int sideOf(const RowsBefore& before, int x, int y, int most) {
    int found = 0;
    for (int away = 1; away < most; ++away)
        if ((found += before.countAround(x, y, away)) >= 2) return away;
    return most;
}

}  // namespace

int mostDotSide(double spacing, double perUnit) {
    const double side = 1.5 * spacing * perUnit;
    return int(std::clamp(std::isfinite(side) ? side : 1.0, 1.0, double(mostGrownDot)));
}

void growDots(std::vector<std::uint64_t>& pixels, int width, int most) {
    if (most <= 1 || pixels.empty()) return;
    const int height = int(pixels.size() / std::size_t(width));
    RowsBefore before(pixels, width, most);
    for (int y = 0; y < height; ++y) {
        before.moveTo(y);
        for (int x = 0; x < width; ++x) {
            const std::uint64_t value = before.at(x, y);
            if (value == 0) continue;
            const int side = sideOf(before, x, y, most), first = (side - 1) / 2, last = side / 2;
            for (int py = std::max(0, y - first); py <= std::min(height - 1, y + last); ++py)
                for (int px = std::max(0, x - first); px <= std::min(width - 1, x + last); ++px) {
                    auto& pixel = pixels[std::size_t(py) * std::size_t(width) + std::size_t(px)];
                    pixel = std::max(pixel, value);
                }
        }
    }
}

}  // namespace scancast
