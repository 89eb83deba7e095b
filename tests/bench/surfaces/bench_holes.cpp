// How closed surfaces are: pixels that show the background, or something far behind, where `pyramid`, which fills what
// is between points, shows a surface; and how far methods reach beyond it. Real scans have no truth: what `pyramid`
// fills is the nearest to one, so numbers are for comparing two builds, or two methods, and not for themselves.
//
//   bench_holes --cloud FILE|SCENE:POINTS … [--method disc,ewa,…] [--distance 1,0.5,…] [--tilt own,15,…] [--width N]
//               [--threads N]
//
// holes    of the pixels of `pyramid`'s surface farther than 2 px from its outline, per cent
// beyond   pixels of the method outside `pyramid`'s outline, per cent of its pixels: how fat silhouettes are
// All leaves are drawn, one sample a pixel. Distances are factors on that of the first view of the whole cloud, a tilt is the
// camera's elevation above the target in degrees.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <string>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/render.hpp"
#include "tests/bench/surfaces/measured_cloud.hpp"
#include "tests/support/pictures/picture_metrics.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

struct Settings {
    std::vector<std::string> clouds, methods{"disc", "ewa", "voronoi", "paraboloid"},
        distances{"1", "0.4", "0.15"}, tilts{"own", "15"};
    int width = 1280, threads = 0;
};

Settings parse(int argc, char** argv) {
    Settings s;
    readOptions(argc, argv,
                {{"--cloud", [&](const std::string& value) { s.clouds.push_back(value); }},
                 wordsOption("--method", s.methods),
                 wordsOption("--distance", s.distances),
                 wordsOption("--tilt", s.tilts),
                 countOption("--width", s.width, 16),
                 countOption("--threads", s.threads, 0)},
                "bench_holes --cloud flight.laz");
    if (s.clouds.empty()) s.clouds = {"town:2000000"};
    return s;
}

View viewOf(const Cloud& cloud, const std::string& distance, const std::string& tilt, int width) {
    View view = defaultView(cloud, width, width * 9 / 16);
    Camera& camera = view.camera;
    const double factor = std::atof(distance.c_str());
    aimFrom(factor, cloud, camera);
    glm::dvec3 arm = camera.eye - camera.target;
    if (tilt != "own") {
        const double angle = glm::radians(std::atof(tilt.c_str()));
        const glm::dvec3 up = glm::normalize(camera.up);
        const glm::dvec3 flat = arm - up * glm::dot(arm, up);
        if (glm::length(flat) > 0)
            arm = glm::length(arm) * (std::cos(angle) * glm::normalize(flat) + std::sin(angle) * up);
    }
    camera.eye = camera.target + factor * arm;
    view.style.shading = Shading::Unlit;
    view.quality.samples = 1;
    return view;
}

Frame drawn(Device& device, const Cloud& cloud, View view, const std::string& method) {
    view.style.method = method;
    return orExit(render(device, cloud, view, {.bruteForce = true}));
}

struct Counts {
    std::uint64_t surface = 0, background = 0, behind = 0, outline = 0, beyond = 0;
};

/// Depths that differ by more than this part are not of one surface: a grazing one's neighbours are nearer to each other.
constexpr float farBehind = 1.05f;

Counts counted(const Frame& picture, const Frame& filled) {
    Counts c;
    PixelMask mask(filled.depth.size());
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = std::isfinite(filled.depth[i]);
    const PixelMask inside = eroded(mask, filled.width, filled.height, 2);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const bool shown = std::isfinite(picture.depth[i]);
        c.outline += mask[i] != 0;
        c.beyond += shown && mask[i] == 0;
        if (inside[i] == 0) continue;
        ++c.surface;
        c.background += !shown;
        c.behind += shown && picture.depth[i] > farBehind * filled.depth[i];
    }
    return c;
}

void measure(Device& device, const Cloud& cloud, const std::string& name, const Settings& s) {
    for (const std::string& distance : s.distances)
        for (const std::string& tilt : s.tilts) {
            const View view = viewOf(cloud, distance, tilt, s.width);
            const Frame filled = drawn(device, cloud, view, "pyramid");
            for (const std::string& method : s.methods) {
                const Counts c = counted(drawn(device, cloud, view, method), filled);
                const double all = double(std::max<std::uint64_t>(c.surface, 1));
                std::printf("| %s | %s | %s | `%s` | %.3f | %.3f | %.3f |\n", name.c_str(), distance.c_str(),
                            tilt.c_str(), method.c_str(), 100 * double(c.background) / all,
                            100 * double(c.behind) / all,
                            100 * double(c.beyond) / double(std::max<std::uint64_t>(c.outline, 1)));
                std::fflush(stdout);
            }
        }
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    const auto device = orExit(createCpuDevice(settings.threads));
    std::shared_ptr<BlockCache> cache;
    std::printf(
        "| cloud | distance | tilt | method | background, %% | far behind, %% | beyond, %% "
        "|\n|---|---|---|---|---|---|---|\n");
    for (const std::string& name : settings.clouds) {
        const auto cloud = measuredCloud(name, settings.threads, SCANCAST_BIN_DIR, cache);
        measure(*device, *cloud, name.substr(name.rfind('/') + 1), settings);
    }
    return 0;
}
