#include "renderer/look/picture_measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace scancast {

namespace {

/// A little more than a viewer needs, since the real picture is larger and smoother than what is measured.
constexpr double leastSpread = 0.28, leastMedian = 0.16, mostMedian = 0.8, mostOfOneColor = 0.3,
                 leastEdges = 0.033;
/// Step of luminance over two pixels that counts as an edge.
constexpr double edgeStep = 0.16;

/// Noise is looked for in every so manieth pixel.
constexpr int noiseStride = 11;

class Pixels2d {
  public:
    explicit Pixels2d(const Frame& frame) : frame_(frame) {}
    bool covered(int x, int y) const { return std::isfinite(depth(x, y)); }
    float depth(int x, int y) const { return frame_.depth[at(x, y)]; }
    const std::uint8_t* color(int x, int y) const { return &frame_.rgba[4 * at(x, y)]; }
    double luminance(int x, int y) const {
        const std::uint8_t* c = color(x, y);
        return (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]) / 255;
    }
    bool isEdge(int x, int y) const {
        const auto step = [&](int dx, int dy) {
            if (!covered(x - dx, y - dy) || !covered(x + dx, y + dy)) return 0.0;
            return std::abs(luminance(x + dx, y + dy) - luminance(x - dx, y - dy));
        };
        return std::hypot(step(1, 0), step(0, 1)) > edgeStep;
    }

    /// Distance of the luminance from the median of the covered ones around; nothing where few are.
    std::optional<double> noise(int x, int y) const {
        std::array<double, 9> around;
        std::size_t n = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if (covered(x + dx, y + dy)) around[n++] = luminance(x + dx, y + dy);
        if (n < 5) return std::nullopt;
        const auto middle = around.begin() + std::ptrdiff_t(n / 2);
        std::nth_element(around.begin(), middle, around.begin() + std::ptrdiff_t(n));
        return std::abs(luminance(x, y) - *middle);
    }

  private:
    std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(frame_.width) + std::size_t(x); }
    const Frame& frame_;
};

/// 1 where `value` reaches `enough`, less where it does not.
double towards(double value, double enough) {
    return std::clamp(value / enough, 0.0, 1.0);
}

/// Positions of the shares `q` of the counted, as shares of all places.
std::array<double, 2> span(const std::vector<std::size_t>& counts, std::size_t all) {
    std::array<double, 2> ends{0, 1};
    std::size_t below = 0;
    bool started = false;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        below += counts[i];
        if (!started && double(below) >= 0.01 * double(all)) {
            ends[0] = double(i) / double(counts.size());
            started = true;
        }
        if (double(below) >= 0.99 * double(all)) {
            ends[1] = double(i + 1) / double(counts.size());
            break;
        }
    }
    return ends;
}

template <class T>
T quantile(std::vector<T>& values, double q) {
    const auto at = values.begin() + std::ptrdiff_t(q * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

bool PictureMeasure::hasContrast() const {
    return spread() >= leastSpread && median >= leastMedian && median <= mostMedian &&
           commonest <= mostOfOneColor;
}

bool PictureMeasure::isReadable() const {
    return hasContrast() && edges >= leastEdges;
}

double PictureMeasure::readability() const {
    const double exposed = std::min(towards(median, leastMedian), towards(1 - median, 1 - mostMedian));
    return (towards(spread(), leastSpread) + exposed + towards(1 - commonest, 1 - mostOfOneColor) +
            towards(edges, leastEdges)) /
           4;
}

PictureMeasure measure(const Frame& frame) {
    const Pixels2d pixels(frame);
    const int width = frame.width, height = frame.height;
    std::vector<std::size_t> columns(std::size_t(width), 0), rows(std::size_t(height), 0), colors(4096, 0);
    std::vector<double> luminances;
    std::vector<double> noises;
    std::vector<float> depths;
    std::size_t border = 0, edges = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (!pixels.covered(x, y)) continue;
            const bool outermost = x == 0 || y == 0 || x == width - 1 || y == height - 1;
            border += outermost;
            ++columns[std::size_t(x)];
            ++rows[std::size_t(y)];
            const std::uint8_t* c = pixels.color(x, y);
            ++colors[std::size_t(c[0] >> 4 << 8 | c[1] >> 4 << 4 | c[2] >> 4)];
            luminances.push_back(pixels.luminance(x, y));
            depths.push_back(pixels.depth(x, y));
            if (outermost) continue;
            edges += pixels.isEdge(x, y);
            if ((x + 5 * y) % noiseStride != 0) continue;
            if (const auto noise = pixels.noise(x, y)) noises.push_back(*noise);
        }
    PictureMeasure m;
    const std::size_t all = luminances.size();
    if (all == 0) return m;
    m.covered = double(all) / (double(width) * height);
    m.border = double(border) / (2.0 * (width + height) - 4);
    const auto x = span(columns, all), y = span(rows, all);
    m.fill = {x[1] - x[0], y[1] - y[0]};
    m.middle = {(x[0] + x[1]) / 2 - 0.5, (y[0] + y[1]) / 2 - 0.5};
    m.dark = quantile(luminances, 0.05);
    m.median = quantile(luminances, 0.5);
    m.bright = quantile(luminances, 0.95);
    m.commonest = double(*std::ranges::max_element(colors)) / double(all);
    m.edges = double(edges) / double(all);
    if (!noises.empty()) m.noise = quantile(noises, 0.5);
    const float nearest = quantile(depths, 0.5) * 0.15f;
    m.near = double(std::ranges::count_if(depths, [&](float d) { return d < nearest; })) / double(all);
    return m;
}

}  // namespace scancast
