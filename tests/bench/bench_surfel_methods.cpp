// How fast the cpu device draws surfels: a unit sphere of N oriented surfels that fills the picture's height,
// in the setting of Talton, Carr and Hart, "Voronoi Rasterization of Sparse Point Sets", 2005, §4 ("on the
// order of 50,000 clipped and smoothly shaded disks" at 1024 x 768: 10 frames/s on its GPU) and with two
// millions of them. Prints milliseconds in all, processor time, and per stage.
//
//   bench_surfel_methods [--threads N] [--repeat N] [--points N] [--only METHOD]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <string>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/draw_surfels.hpp"

namespace {

using namespace scancast;

struct Options {
    std::uint64_t points = 0;  ///< 0: 50,000, then two millions
    int threads = 0;
    int repeat = 25;
    std::string only;
};

Options parse(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto value = [&] { return i + 1 < argc ? std::strtoull(argv[++i], nullptr, 10) : 0; };
        if (std::strcmp(argv[i], "--points") == 0)
            o.points = value();
        else if (std::strcmp(argv[i], "--threads") == 0)
            o.threads = static_cast<int>(value());
        else if (std::strcmp(argv[i], "--repeat") == 0)
            o.repeat = std::max(1, static_cast<int>(value()));
        else if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc)
            o.only = argv[++i];
        else {
            std::fprintf(
                stderr, "bench_surfel_methods: unknown option %s; example: bench_surfel_methods --only ewa\n",
                argv[i]);
            std::exit(2);
        }
    }
    return o;
}

/// Radii as ingest estimates them: the mean distance to 10 neighbours, 1.27 times the mean spacing.
test::AnalyticCloud sphere(std::uint64_t count) {
    test::Numbers numbers(1);
    const double spacing = std::sqrt(4 * 3.14159265 / double(count));
    std::vector<test::AnalyticPoint> points(count);
    for (auto& p : points) {
        p.position = numbers.onSphere();
        p.rgb = numbers.color();
        const glm::dvec3 along = glm::cross(p.position, numbers.onSphere());
        p.surfel = test::surfelOf(p.position, 1.27 * spacing, glm::normalize(along), numbers.uniform(0.5, 1));
    }
    return {points, spacing, 16384};
}

double median(std::vector<double> v) {
    std::ranges::nth_element(v, v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
    return v[v.size() / 2];
}

void measure(Device& device, const test::AnalyticCloud& cloud, const char* name, const char* label,
             const ParameterValues& parameters, Shading shading, int width, int height, int repeat) {
    const Method& method = *findMethod(name);
    const PassList passes = method.passes({method, resolveParameters(method, parameters).value(), shading});
    std::vector<double> times, cpuTimes;
    std::map<std::string, std::vector<double>> stages;
    for (int i = 0; i < repeat + 3; ++i) {
        // A different side each time, as in an orbit; the sphere fills the picture's height.
        const double angle = 0.05 * i;
        const Viewpoint view =
            test::lookAt({2.3 * std::cos(angle), 2.3 * std::sin(angle), 0.3}, {0, 0, 0}, width, height, 55);
        test::SurfelScene scene(view, cloud.cut(), passes);
        scene.drawing.oriented = true;
        const std::clock_t cpuStart = std::clock();
        const auto start = std::chrono::steady_clock::now();
        const auto frame = device.draw(scene.drawing, {});
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (!frame) {
            std::fprintf(stderr, "bench_surfel_methods: %s\n", frame.error().message.c_str());
            std::exit(1);
        }
        if (i < 3) continue;
        times.push_back(ms);
        cpuTimes.push_back(1000.0 * double(std::clock() - cpuStart) / CLOCKS_PER_SEC);
        for (const StageTime& s : frame->stats.stages) stages[s.name].push_back(s.milliseconds);
    }
    std::printf("%-24s %8.2f ms = %5.1f frames/s  (best %.2f, cpu %.2f)", label, median(times),
                1000 / median(times), *std::ranges::min_element(times), *std::ranges::min_element(cpuTimes));
    for (const auto& [stage, ms] : stages) std::printf("  %s %.2f", stage.c_str(), median(ms));
    std::printf("\n");
}

void measureAll(Device& device, std::uint64_t count, int width, int height, const Options& o) {
    std::printf("%llu surfels, %d x %d\n", static_cast<unsigned long long>(count), width, height);
    const test::AnalyticCloud cloud = sphere(count);
    const auto one = [&](const char* name, const char* label, const ParameterValues& parameters,
                         Shading shading = Shading::Phong) {
        if (o.only.empty() || o.only == name)
            measure(device, cloud, name, label, parameters, shading, width, height, o.repeat);
    };
    one("disc", "disc", {});
    one("disc", "disc, unlit", {}, Shading::Unlit);
    one("ewa", "ewa", {});
    one("ewa", "ewa, unlit", {}, Shading::Unlit);
    one("voronoi", "voronoi, smooth", {});
    one("voronoi", "voronoi, flat", {{"smooth", false}});
    one("voronoi", "voronoi, silhouette", {{"silhouette", true}});
    one("paraboloid", "(paraboloid, unlit)", {}, Shading::Unlit);
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = parse(argc, argv);
    const auto device = createCpuDevice(options.threads);
    if (!device) {
        std::fprintf(stderr, "bench_surfel_methods: %s\n", device.error().message.c_str());
        return 1;
    }
    std::printf("%s\n", (*device)->info().renderer.c_str());
    if (options.points == 0 || options.points == 50'000) measureAll(**device, 50'000, 1024, 768, options);
    if (options.points != 50'000)
        measureAll(**device, options.points == 0 ? 2'000'000 : options.points, 1280, 720, options);
    return 0;
}
