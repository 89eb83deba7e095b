// Surfels per second, of ours and of the references, and how well they agree, side by side.
//   bench_surfels --with nanoflann,pcl --threads 2 town 2000000      (a scene of the simulator)
//   bench_surfels --with pcl scan.las
// The reference is PCL (NormalEstimationOMP over its kd-tree), which the program itself does not link. Points
// are distinct, and in Morton order, as the octree builder hands them over. Ours includes radii, axes,
// outliers and doublings; PCL gives normals alone. The fastest of --repeats (3) runs counts.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/surfels/spatial_sort.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/compare_surfels.hpp"
#include "tests/support/clouds/scan_points.hpp"

using namespace scancast;

namespace {

struct Settings {
    std::string with = "nanoflann,pcl", scan = "town";
    std::uint64_t points = 1'000'000;
    int threads = 2, neighbours = 10, repeats = 3;
};

Settings parse(int argc, char** argv) {
    Settings s;
    int place = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--with" && i + 1 < argc)
            s.with = argv[++i];
        else if (word == "--threads" && i + 1 < argc)
            s.threads = std::max(1, std::atoi(argv[++i]));
        else if (word == "--repeats" && i + 1 < argc)
            s.repeats = std::max(1, std::atoi(argv[++i]));
        else if (word == "-k" && i + 1 < argc)
            s.neighbours = std::max(1, std::atoi(argv[++i]));
        else if (place++ == 0)
            s.scan = word;
        else
            s.points = std::uint64_t(std::atof(word.c_str()));
    }
    return s;
}

Expected<std::unique_ptr<PointSource>> open(const Settings& s) {
    if (std::filesystem::exists(s.scan)) return openScan(s.scan, {.importerDirectory = SCANCAST_BIN_DIR});
    SceneOptions options;
    options.scene = s.scan;
    options.points = s.points;
    return simulate(options);
}

std::vector<glm::vec3> inMortonOrder(const std::vector<glm::vec3>& points) {
    const SpatialOrder sorted = spatialOrder(points);
    std::vector<glm::vec3> distinct;
    for (std::size_t i = 0; i + 1 < sorted.firstOf.size(); ++i)
        distinct.push_back(points[sorted.order[sorted.firstOf[i]]]);
    return distinct;
}

/// On a machine that does other things too, processor time says more than the clock.
struct Time {
    double seconds = 1e300, processor = 1e300;
};

void print(const char* name, std::size_t points, const Time& time) {
    std::printf("%-10s %8.3f s  %6.2f million/s  %4.0f ns of processor time each", name, time.seconds,
                double(points) / time.seconds / 1e6, time.processor / double(points) * 1e9);
}

template <class F>
Time fastest(const Settings& settings, const F& run) {
    Time least;
    for (int i = 0; i < settings.repeats; ++i) {
        const Time time = run();
        least = {std::min(least.seconds, time.seconds), std::min(least.processor, time.processor)};
    }
    return least;
}

template <class F>
void printReference(const char* name, const std::vector<Surfel>& ours, const std::vector<glm::vec3>& points,
                    const Settings& settings, const F& estimate) {
    test::ReferenceSurfels theirs;
    const Time time = fastest(settings, [&] {
        theirs = estimate(points, settings.neighbours, settings.threads);
        return Time{theirs.seconds, theirs.processor};
    });
    print(name, points.size(), time);
    const test::Agreement a = test::compare(ours, theirs.surfels);
    std::printf(
        "\n           agrees: %.3f %% of normals within 1°, %.3f %% of radii within 1 %%, of %.1f %% "
        "compared\n",
        100 * a.share(a.normals), 100 * a.share(a.radii), 100 * double(a.compared) / double(ours.size()));
}

void describe(const std::vector<Surfel>& surfels) {
    std::vector<float> reach;
    std::size_t outliers = 0, directionless = 0;
    for (const Surfel& s : surfels) {
        outliers += s.outlier;
        directionless += s.normal == glm::vec3(0);
        if (s.radius > 0) reach.push_back(s.major / s.radius);
    }
    if (reach.empty()) return;
    std::sort(reach.begin(), reach.end());
    const auto quantile = [&](double q) { return double(reach[std::size_t(q * double(reach.size() - 1))]); };
    std::printf("major/radius: 5 %% %.3f, median %.3f, 95 %% %.3f; %zu outliers, %zu without a normal\n",
                quantile(0.05), quantile(0.5), quantile(0.95), outliers, directionless);
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    const auto source = open(settings);
    const auto read = source ? test::readPositions(**source) : tl::unexpected(source.error());
    if (!read) {
        std::fprintf(stderr, "%s\n", read.error().message.c_str());
        return 1;
    }
    const std::vector<glm::vec3> points = inMortonOrder(*read);
    std::printf("%zu points, %zu distinct; k = %d, %d threads\n", read->size(), points.size(),
                settings.neighbours, settings.threads);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(settings.threads));
    std::vector<Surfel> ours(points.size());
    const auto has = [&](const char* name) { return settings.with.find(name) != std::string::npos; };
    const Time time = fastest(settings, [&] {
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t before = std::clock();
        estimateSurfels(points, {.neighbours = settings.neighbours}, ours);
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
        return Time{passed.count(), double(std::clock() - before) / CLOCKS_PER_SEC};
    });
    print("ours", points.size(), time);
    std::printf("\n");
    if (has("nanoflann")) printReference("nanoflann", ours, points, settings, test::surfelsByNanoflann);
    if (has("pcl")) printReference("pcl", ours, points, settings, test::surfelsByPcl);
    describe(ours);
}
