// What the screen passes of docs/spec/pyramid.md §1 cost, in the setting of Bouchiba, Deschaud and Goulette,
// "Raw point cloud deferred shading through screen space pyramidal operators", 2018, §4: 1248 x 768, hidden
// point removal, then pull-push and normals, on pictures of two sheets of points. Prints milliseconds per
// pass, medians, for 1 and 2 threads; and for table 1 what its predecessor costs, which asks every pixel within a
// fixed radius (Pintus, Gobbetti and Agus, "Real-time Rendering of Massive Unstructured Raw Point Clouds Using
// Screen-space Operators", 2011), with 15 and 25 px, and of how many points it says the same.
//
//   bench_pyramid [--repeat N]
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/support/pictures/point_screen.hpp"

namespace {

using namespace scancast;
using Clock = std::chrono::steady_clock;

double medianOf(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

/// Points every `spacingPx` px with a noise of 0.3 spacings, and others six spacings behind.
test::PointScreen twoSheets(double spacingPx, double& spacing) {
    test::PointScreen screen(1248, 768, true, 665);
    const double depth = 10;
    spacing = spacingPx * depth / screen.pixelsPerUnit;
    test::Numbers numbers(1);
    for (const double d : {depth, depth + 6.6 * spacing}) {
        test::sheet(d, 1.1 * d, 0.7 * d, spacing, 0.3 * spacing, numbers,
                    [&](const test::ScreenPoint& p) { screen.add(p, d > depth ? 1 : 0); });
    }
    return screen;
}

/// The occlusion of docs/spec/pyramid.md §4.3 by every pixel within a radius, eight sectors by direction: for each
/// neighbour a row at a time, so that the compiler makes vectors of it. No closing: points only, as in a picture of a scene
/// without background.
class Exhaustive {
  public:
    Exhaustive(const test::PointScreen& s, double minGap, int threads)
        : s_(s), minGap_(static_cast<float>(minGap)), arena_(threads) {
        x_.resize(s.depth.size());
        y_.resize(s.depth.size());
        square_.resize(s.depth.size());
        for (int y = 0; y < s.height; ++y) {
            for (int x = 0; x < s.width; ++x) {
                const std::size_t i = s.at(x, y);
                const test::ScreenPoint ray = s.through(x, y);
                const auto d = double(s.depth[i]);
                const bool point = std::isfinite(d);
                x_[i] = point ? static_cast<float>(ray.x * d) : 0;
                y_[i] = point ? static_cast<float>(ray.y * d) : 0;
                square_[i] = point ? static_cast<float>(d * d * (ray.x * ray.x + ray.y * ray.y + 1)) : 1;
            }
        }
    }

    /// Pixels whose point is hidden.
    std::vector<std::uint8_t> hidden(int radius, double threshold) {
        std::vector<std::uint8_t> out(s_.depth.size());
        arena_.execute(
            [&] { tbb::parallel_for(0, s_.height, [&](int y) { hideRow(y, radius, threshold, out); }); });
        return out;
    }

  private:
    static int sectorOf(int dx, int dy) {
        constexpr int ofEighth[8] = {4, 7, 6, 5, 3, 0, 1, 2};  // from the east on, downwards
        const double eighths = std::atan2(dy, dx) / 0.78539816339744831;
        return ofEighth[static_cast<unsigned>(std::lround(eighths) + 8) % 8];
    }

    void hideRow(int y, int radius, double threshold, std::vector<std::uint8_t>& out) const {
        const int width = s_.width;
        std::vector<float> best(8 * static_cast<std::size_t>(width));
        const std::size_t own = s_.at(0, y);
        for (int dy = std::max(-radius, -y); dy <= std::min(radius, s_.height - 1 - y); ++dy) {
            for (int dx = -radius; dx <= radius; ++dx) {
                if ((dx == 0 && dy == 0) || dx * dx + dy * dy > radius * radius) continue;
                float* const sector = best.data() + sectorOf(dx, dy) * width;
                const std::size_t other = s_.at(0, y + dy);
                const int x0 = std::max(0, -dx), x1 = std::min(width, width - dx);
                for (int x = x0; x < x1; ++x) {
                    const auto i = own + static_cast<std::size_t>(x);
                    const auto j = other + static_cast<std::size_t>(x + dx);
                    const float gap = s_.depth[i] - s_.depth[j], wx = x_[i] - x_[j], wy = y_[i] - y_[j];
                    const float along = wx * x_[j] + wy * y_[j] + gap * s_.depth[j];
                    const float squared = along * along / ((wx * wx + wy * wy + gap * gap) * square_[j]);
                    const bool occludes = gap >= minGap_ && along > 0;
                    sector[x] = occludes && squared > sector[x] ? squared : sector[x];
                }
            }
        }
        for (int x = 0; x < width; ++x) {
            float sum = 0;
            for (int s = 0; s < 8; ++s)
                sum += 1 - std::sqrt(std::min(best[static_cast<std::size_t>(s * width + x)], 1.0f));
            const std::size_t i = own + static_cast<std::size_t>(x);
            out[i] = std::isfinite(s_.depth[i]) && sum < 8 * static_cast<float>(threshold) ? 1 : 0;
        }
    }

    const test::PointScreen& s_;
    const float minGap_;
    tbb::task_arena arena_;
    std::vector<float> x_, y_, square_;
};

/// The pass here and its predecessor, on one picture.
void measurePredecessor(double spacingPx, int threads, int repeat) {
    double spacing = 0;
    test::PointScreen screen = twoSheets(spacingPx, spacing);
    HiddenPointsPass hide;
    hide.scale = 5;
    hide.spacing = static_cast<float>(spacing);
    hide.detail = 0;
    test::PyramidRunner runner(threads);
    runner.hidePoints(screen, hide);
    Exhaustive exhaustive(screen, 0, threads);
    for (const int radius : {15, 25}) {
        std::vector<double> times;
        std::size_t points = 0, same = 0;
        for (int i = 0; i < repeat + 1; ++i) {
            const auto start = Clock::now();
            const auto hidden = exhaustive.hidden(radius, double(hide.threshold));
            if (i > 0)
                times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
            points = same = 0;
            for (std::size_t p = 0; p < hidden.size(); ++p) {
                if (screen.surface[p] < 0) continue;
                ++points;
                same += (hidden[p] != 0) == (screen.labels[p] == hiddenLabel) ? 1 : 0;
            }
        }
        std::printf(
            "points every %g px, threads: %d  every pixel within %d px %8.1f ms, of points the same %.2f "
            "%%\n",
            spacingPx, threads, radius, medianOf(times), 100.0 * double(same) / double(points));
    }
}

void measure(double spacingPx, int threads, int repeat) {
    double spacing = 0;
    const test::PointScreen screen = twoSheets(spacingPx, spacing);
    HiddenPointsPass hide;
    hide.spacing = static_cast<float>(spacing);
    hide.detail = 0;
    hide.minGap = static_cast<float>(3 * spacing);
    DepthNormalsPass normals;
    normals.spacing = hide.spacing;
    normals.detail = 0;
    test::PyramidRunner runner(threads);
    std::vector<double> times[3];
    for (int i = 0; i < repeat + 2; ++i) {
        test::PointScreen s = screen;
        const auto timed = [&](std::vector<double>& into, const auto& work) {
            const auto start = Clock::now();
            work();
            if (i >= 2) {
                into.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
            }
        };
        timed(times[0], [&] { runner.hidePointsOnly(s, hide); });
        timed(times[1], [&] { runner.fill(s, {}); });
        timed(times[2], [&] { runner.findNormals(s, normals); });
    }
    std::printf(
        "points every %g px, threads: %d  hidden points %6.2f ms  pull-push %6.2f ms  normals %6.2f ms\n",
        spacingPx, threads, medianOf(times[0]), medianOf(times[1]), medianOf(times[2]));
}

}  // namespace

int main(int argc, char** argv) {
    int repeat = 25;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--repeat") == 0 && i + 1 < argc) {
            repeat = std::max(1, std::atoi(argv[++i]));
        } else {
            std::fprintf(stderr, "bench_pyramid: unknown option %s; example: bench_pyramid --repeat 25\n",
                         argv[i]);
            return 2;
        }
    }
    for (const double spacingPx : {1.0, 2.0, 4.0, 8.0}) {
        for (const int threads : {1, 2}) measure(spacingPx, threads, repeat);
        measurePredecessor(spacingPx, 2, std::max(1, repeat / 8));
    }
    return 0;
}
