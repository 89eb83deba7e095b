// How fast the cpu device draws the sphere of the targets: POINTS points of a unit sphere, 1280 x 720, from
// cut to RGBA and depth in memory. Prints a table: million points a second, and milliseconds per stage.
//
//   bench_cpu_device [--points N] [--threads N] [--repeat N] [--leaf N] [--unordered] [--only METHOD]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace {

using namespace scancast;

struct Options {
    std::uint64_t points = 2'000'000;
    int threads = 0;
    int repeat = 25;
    std::uint32_t leaf = 16384;
    bool unordered = false;
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
        else if (std::strcmp(argv[i], "--leaf") == 0)
            o.leaf = std::max(1u, static_cast<std::uint32_t>(value()));
        else if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc)
            o.only = argv[++i];
        else if (std::strcmp(argv[i], "--unordered") == 0)
            o.unordered = true;
        else {
            std::fprintf(stderr,
                         "bench_cpu_device: unknown option %s; example: bench_cpu_device --points 2000000\n",
                         argv[i]);
            std::exit(2);
        }
    }
    return o;
}

test::AnalyticCloud sphere(const Options& o) {
    test::Numbers numbers(1);
    std::vector<test::AnalyticPoint> points(o.points);
    for (auto& p : points) {
        p.position = numbers.onSphere();
        p.rgb = numbers.color();
    }
    return {points, std::sqrt(4 * 3.14159265 / double(o.points)), o.leaf, !o.unordered};
}

void measure(Device& device, const test::AnalyticCloud& cloud, const char* name,
             const ParameterValues& parameters, Shading shading, int repeat) {
    const Method& method = *findMethod(name);
    const PassList passes = method.passes({method, resolveParameters(method, parameters).value(), shading});
    const glm::dvec2 jitter{0, 0};
    std::vector<double> times, cpuTimes;
    std::map<std::string, std::vector<double>> stages;
    for (int i = 0; i < repeat + 3; ++i) {
        // A different side each time, as in an orbit; the sphere fills the picture's height.
        const double angle = 0.05 * i;
        const Viewpoint view =
            test::lookAt({2.3 * std::cos(angle), 2.3 * std::sin(angle), 0.3}, {0, 0, 0}, 1280, 720);
        Drawing d;
        const CutView cut{view, cloud.cut(), {}};
        d.cuts = {&cut, 1};
        d.passes = passes;
        d.window = {0, 0, 1280, 720};
        d.jitter = {&jitter, 1};
        const std::clock_t cpuStart = std::clock();
        const auto start = std::chrono::steady_clock::now();
        const auto frame = device.draw(d, {});
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (!frame) {
            std::fprintf(stderr, "bench_cpu_device: %s\n", frame.error().message.c_str());
            std::exit(1);
        }
        if (i < 3) continue;
        times.push_back(ms);
        cpuTimes.push_back(1000.0 * double(std::clock() - cpuStart) / CLOCKS_PER_SEC);
        for (const StageTime& s : frame->stats.stages) stages[s.name].push_back(s.milliseconds);
    }
    const auto median = [](std::vector<double> v) {
        std::ranges::nth_element(v, v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
        return v[v.size() / 2];
    };
    std::string label = name;
    if (const auto size = parameters.find("sizePx"); size != parameters.end()) {
        char text[32];
        std::snprintf(text, sizeof text, " %g px", std::get<double>(size->second));
        label += text;
    }
    std::printf("%-18s %8.1f Mpts/s %8.2f ms  (best %.2f, cpu %.2f)", label.c_str(),
                double(cloud.cut().samples) / median(times) / 1000, median(times),
                *std::ranges::min_element(times), *std::ranges::min_element(cpuTimes));
    for (const auto& [stage, ms] : stages) std::printf("  %s %.2f", stage.c_str(), median(ms));
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = parse(argc, argv);
    const auto device = createCpuDevice(options.threads);
    if (!device) {
        std::fprintf(stderr, "bench_cpu_device: %s\n", device.error().message.c_str());
        return 1;
    }
    std::printf("%s, %llu points, 1280 x 720\n", (*device)->info().renderer.c_str(),
                static_cast<unsigned long long>(options.points));
    const test::AnalyticCloud cloud = sphere(options);
    const auto wanted = [&](const char* name) { return options.only.empty() || options.only == name; };
    if (wanted("point")) measure(**device, cloud, "point", {}, Shading::Unlit, options.repeat);
    for (const char* name : {"square", "circle", "paraboloid", "cone", "sphere"}) {
        if (!wanted(name)) continue;
        for (const double px : {2.0, 3.0, 5.0, 9.0}) {
            measure(**device, cloud, name, {{"sizePx", px}}, Shading::Unlit, options.repeat);
        }
    }
    if (wanted("paraboloid")) measure(**device, cloud, "paraboloid", {}, Shading::Unlit, options.repeat);
    if (!options.only.empty()) return 0;
    std::printf("with eye-dome lighting:\n");
    measure(**device, cloud, "point", {}, Shading::EyeDome, options.repeat);
    return 0;
}
