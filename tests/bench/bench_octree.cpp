// How fast a scan becomes an octree, and a view a cut. Prints one line a measurement.
// Usage: bench_octree [million points = 20] [threads = 0 (all)] [scene = town; ground, ball or a scene of the
// simulator] [surfels]
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/select/select.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

using namespace scancast;
using Clock = std::chrono::steady_clock;

namespace {

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double peakMegabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

Expected<std::unique_ptr<PointSource>> open(const std::string& scene, std::uint64_t points) {
    if (scene == "ground") return std::make_unique<test::SyntheticSource>(points, test::ground, Attributes{});
    if (scene == "ball") return std::make_unique<test::SyntheticSource>(points, test::ball, Attributes{});
    SceneOptions options;
    options.scene = scene;
    options.points = points;
    return simulate(options);
}

void describe(const Cloud& cloud) {
    std::uint64_t leaves = 0, inner = 0, innerSamples = 0;
    for (const Node& n : cloud.octree.nodes()) {
        (n.isLeaf() ? leaves : inner) += 1;
        innerSamples += n.isLeaf() ? 0 : n.sampleCount;
    }
    const glm::dvec3 size = cloud.bounds[1] - cloud.bounds[0];
    std::printf("cloud: %.4g × %.4g × %.4g\n", size.x, size.y, size.z);
    std::printf(
        "octree: %llu leaves, %llu inner nodes with %.0f samples on average, %.2f samples a point, s0 %.4g\n",
        (unsigned long long)leaves, (unsigned long long)inner,
        inner ? double(innerSamples) / double(inner) : 0.0,
        double(cloud.octree.sampleCount()) / double(cloud.points), cloud.spacing);
}

void benchSelect(const Cloud& cloud, double detail) {
    View view;
    view.camera = cloud.defaultCamera(double(view.width) / view.height);
    for (const double nearer : {1.0, 0.3, 0.1}) {
        view.camera.eye = view.camera.target + (view.camera.eye - view.camera.target) * nearer;
        const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
        if (!viewpoint) continue;
        SelectOptions options;
        options.detail = detail;
        const int repeats = 50;
        const auto start = Clock::now();
        Cut cut;
        for (int i = 0; i < repeats; ++i) cut = select(cloud.octree, *viewpoint, options);
        std::printf("select: τ %.1f, %u visited, %zu runs, %llu samples, %.3f ms\n", detail, cut.nodesVisited,
                    cut.runs.size(), (unsigned long long)cut.samples, secondsSince(start) / repeats * 1e3);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const double millions = argc > 1 ? std::atof(argv[1]) : 20;
    BuildOptions options;
    options.threads = argc > 2 ? std::atoi(argv[2]) : 0;
    options.shape.surfels = argc > 4;
    const auto source = open(argc > 3 ? argv[3] : "town", std::uint64_t(millions * 1e6));
    if (!source) {
        std::fprintf(stderr, "%s\n", source.error().message.c_str());
        return 1;
    }
    const auto start = Clock::now();
    std::string stage;
    auto stageStart = start;
    const auto cloud = buildCloud(**source, options, [&](const Progress& p) {
        if (p.total != p.done || stage == p.stage) return;
        stage = p.stage;
        std::printf("%s: %.2f s\n", stage.c_str(), secondsSince(stageStart));
        stageStart = Clock::now();
    });
    if (!cloud) {
        std::fprintf(stderr, "%s\n", cloud.error().message.c_str());
        return 1;
    }
    const double seconds = secondsSince(start);
    std::printf("build: %.1f million points in %.2f s, %.2f million points/s, peak %.0f MB\n", millions,
                seconds, millions / seconds, peakMegabytes());
    describe(**cloud);
    for (const double detail : {0.5, 1.0, 2.0}) benchSelect(**cloud, detail);
}
