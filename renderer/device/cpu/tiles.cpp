#include "renderer/device/cpu/tiles.hpp"

#include <algorithm>
#include <array>

namespace scancast::cpu {
namespace {

constexpr double cyclesPerPixel = 4;      // clear and resolve
constexpr double projectionShare = 0.25;  // of a run's work is done in every tile that it touches
constexpr int smallestSide = 32;
constexpr int snap = tileSteps;  // borders on multiples of a cache line of rgba
constexpr int bins = 64;

double workInside(const PreparedRun& run, const Rect& area) {
    const Rect part = run.bounds.intersect(area);
    if (part.empty()) return 0;
    const double share =
        double(part.width()) * part.height() / (double(run.bounds.width()) * run.bounds.height());
    return run.work * (projectionShare + (1 - projectionShare) * share);
}

Tile makeTile(const Rect& area, std::span<const PreparedRun> runs,
              std::span<const std::uint32_t> candidates) {
    Tile tile;
    tile.area = area;
    tile.work = cyclesPerPixel * area.width() * area.height();
    for (const std::uint32_t i : candidates) {
        const double work = workInside(runs[i], area);
        if (work <= 0) continue;
        tile.work += work;
        tile.runs.push_back(i);
    }
    return tile;
}

/// Where to cut the longer side, so that both halves have the same work: by a histogram of the runs' middles.
int cutPosition(const Tile& tile, std::span<const PreparedRun> runs, bool vertical) {
    const int start = vertical ? tile.area.x0 : tile.area.y0;
    const int length = vertical ? tile.area.width() : tile.area.height();
    std::array<double, bins> histogram;
    histogram.fill(cyclesPerPixel * tile.area.width() * tile.area.height() / bins);
    for (const std::uint32_t i : tile.runs) {
        const Rect part = runs[i].bounds.intersect(tile.area);
        const int middle = (vertical ? part.x0 + part.x1 : part.y0 + part.y1) / 2 - start;
        histogram[static_cast<std::size_t>(std::clamp(middle * bins / length, 0, bins - 1))] +=
            workInside(runs[i], tile.area);
    }
    double total = 0, sum = 0;
    for (const double h : histogram) total += h;
    std::size_t bin = 0;
    while (bin + 1 < bins && sum + histogram[bin] < total / 2) sum += histogram[bin++];
    const int wished =
        start + static_cast<int>(length * (double(bin) + (total / 2 - sum) / histogram[bin]) / bins);
    const int snapped = start + (wished - start + snap / 2) / snap * snap;
    return std::clamp(snapped, start + smallestSide, start + (length - smallestSide) / snap * snap);
}

bool canCut(const Rect& r) {
    return std::max(r.width(), r.height()) >= 2 * smallestSide;
}

struct LessWork {
    bool operator()(const Tile& a, const Tile& b) const { return priority(a) < priority(b); }
    // Tiles that are too large come first, then the heaviest that can still be cut.
    static double priority(const Tile& t) {
        if (!canCut(t.area)) return -1;
        const bool tooLarge = double(t.area.width()) * t.area.height() > maxTilePixels;
        return tooLarge ? 1e30 + t.work : t.work;
    }
};

}  // namespace

std::vector<Tile> cutIntoTiles(const Rect& area, std::span<const PreparedRun> runs, int wanted) {
    std::vector<std::uint32_t> all(runs.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<Tile> heap{makeTile(area, runs, all)};
    const auto mustCut = [&] {
        const Tile& top = heap.front();
        if (!canCut(top.area)) return false;
        return heap.size() < static_cast<std::size_t>(wanted) ||
               double(top.area.width()) * top.area.height() > maxTilePixels;
    };
    while (mustCut()) {
        std::pop_heap(heap.begin(), heap.end(), LessWork{});
        const Tile tile = std::move(heap.back());
        heap.pop_back();
        const bool vertical = tile.area.width() >= tile.area.height();
        const int position = cutPosition(tile, runs, vertical);
        Rect first = tile.area, second = tile.area;
        (vertical ? first.x1 : first.y1) = position;
        (vertical ? second.x0 : second.y0) = position;
        for (const Rect& half : {first, second}) {
            heap.push_back(makeTile(half, runs, tile.runs));
            std::push_heap(heap.begin(), heap.end(), LessWork{});
        }
    }
    std::ranges::sort(heap, [](const Tile& a, const Tile& b) { return a.work > b.work; });
    return heap;
}

}  // namespace scancast::cpu
