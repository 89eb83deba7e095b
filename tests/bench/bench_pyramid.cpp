// What the screen passes of docs/spec/pyramid.md §1 cost, in the setting of Bouchiba, Deschaud and Goulette,
// "Raw point cloud deferred shading through screen space pyramidal operators", 2018, §4: 1248 x 768, hidden
// point removal, then pull-push and normals, on pictures of two sheets of points. Prints milliseconds per
// pass, medians, for 1 and 2 threads.
//
//   bench_pyramid [--repeat N]
#include <algorithm>
#include <chrono>
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
    }
    return 0;
}
