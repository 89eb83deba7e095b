// How well surfaces are lit from few samples, flat and curved surfels: generated scenes, whose normals are known, are drawn at a
// coarse τ in clay under a lamp, and compared with the same light on the normals that rays through the scene itself meet.
//
//   compare_normals [TAU] [POINTS] [NOISE]           8 px; 0: each scene's own; 1 times the scene's own
//
// PSNR over the pixels that the scene fills; ms: median of 9 pictures, all passes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/render.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/ground_truth/ground_truth.hpp"
#include "tests/support/clouds/scene_clouds.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

constexpr Rgb8 clay{200, 184, 144};

/// docs/spec/shading.md §2, with a lamp alone, of the first channel.
double lit(const glm::dvec3& n, const glm::dvec3& toEye) {
    const glm::dvec3 facing = glm::dot(n, toEye) < 0 ? -n : n;
    const glm::dvec3 lamp = glm::normalize(toEye + glm::dvec3(-0.5, 1 / std::sqrt(12.0), 0));
    const double near = std::max(0.0, (glm::dot(facing, lamp) + 0.4) / 1.4);
    const double b = (1 - (1 - near) * (1 - near)) / 0.91, c = clay[0] / 255.0;
    return 255 * (b <= 1 ? c * b : c + (b - 1) * c * (1 - c));
}

double psnr(const Frame& frame, const GroundTruth& truth, const Viewpoint& view) {
    double squares = 0, pixels = 0;
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x) {
            const std::size_t at = truth.at(x, y);
            if (truth.coverage[at] < 1 || truth.normal[at] == glm::vec3(0)) continue;
            const glm::dvec3 n = glm::dmat3(view.cloudToView) * glm::dvec3(truth.normal[at]);
            const glm::dvec3 ray((x + 0.5 - truth.width / 2.0) / view.pixelsPerUnit,
                                 (truth.height / 2.0 - y - 0.5) / view.pixelsPerUnit, -1);
            const double error = frame.rgba[4 * at] - lit(n, -glm::normalize(ray));
            squares += error * error;
            ++pixels;
        }
    return 10 * std::log10(255 * 255 * pixels / squares);
}

void compare(const std::string& scene, std::uint64_t points, double tau, double noise) {
    SceneOptions options;
    options.scene = scene;
    options.points = points;
    options.noise = noise;
    options.origin = glm::dvec3(0);
    BuildOptions build;
    build.shape.surfels = true;
    const auto cloud = orExit(buildCloud(*orExit(simulate(options)), build));
    const RayCaster caster = orExit(RayCaster::create(options));
    const auto device = orExit(createCpuDevice(0));
    for (const char* method : {"disc", "ewa"}) {
        double sum[2] = {}, ms[2] = {};
        std::size_t views = 0;
        for (const SceneView& from : sceneViews(scene)) {
            View view = defaultView(*cloud, 960, 540);
            view.camera = test::cameraOf(from);
            view.style.method = method;
            view.style.shading = Shading::Phong;
            view.style.color = ColorSource::Flat;
            view.style.flatColor = clay;
            view.style.light.ambient = 0;
            view.style.light.headlight = 1;
            view.style.light.shine = 0;
            view.quality.detail = tau;
            view.quality.samples = 1;
            const Viewpoint viewpoint = orExit(Viewpoint::create(view, cloud->origin, cloud->bounds));
            const GroundTruth truth =
                orExit(castRays(caster, viewpoint, {.supersampling = 2, .cloudOrigin = cloud->origin}));
            ++views;
            for (const bool curved : {false, true}) {
                view.style.parameters = {{"curved", curved}};
                std::vector<double> times;
                for (int i = 0; i < 9; ++i) {
                    const auto frame = orExit(render(*device, *cloud, view));
                    if (i == 0) sum[curved] += psnr(frame, truth, viewpoint);
                    double all = 0;
                    for (const auto& stage : frame.stats.stages) all += stage.milliseconds;
                    times.push_back(all);
                }
                ms[curved] += median(times);
            }
        }
        const double n = double(views);
        std::printf("| %s, %lluk | %s | %.2f | %.2f | %.1f | %.1f |\n", scene.c_str(),
                    static_cast<unsigned long long>(points / 1000), method, sum[0] / n, sum[1] / n, ms[0] / n,
                    ms[1] / n);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const double tau = argc > 1 ? std::atof(argv[1]) : 8;
    const std::uint64_t points = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
    const double noise = argc > 3 ? std::atof(argv[3]) : 1;
    std::printf(
        "| scene | method | flat, dB | curved, dB | flat, ms | curved, ms |\n|---|---|--:|--:|--:|--:|\n");
    for (const auto& [scene, own] :
         {std::pair("torus", 100'000u), std::pair("sphere", 100'000u), std::pair("statue", 600'000u)})
        compare(scene, points ? points : own, tau, noise);
}
