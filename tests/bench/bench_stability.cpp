// How much pictures change while the camera moves: by how much more than the same pictures drawn by brute
// force, and how much of it is changes of level. Prints a table of percentages of pixels that change by more
// than 16 of 255.
//
//   bench_stability [--cloud town:2000000|FILE]... [--method A,B,…] [--detail D,…] [--motion
//   orbit,zoom,parallel]
//                   [--distance 1,0.2,…] [--steps N] [--no-brute-force] [--threads N] [--samples N,…]
//                   [--shading unlit|phong|eyedome] [--param NAME=NUMBER|true|false]…
//
// With --samples 16 what is measured is the motion itself: points move by parts of a pixel, and what they show
// with them, however well that is drawn.
// "parallel" is a zoom without perspective: everything of one spacing would change its level at once.
// Distances are factors on that of the view of the whole cloud. Detail "auto" is the method's own.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

#include "renderer/device/cpu/cpu_device.hpp"
#include "tests/bench/surfaces/measured_cloud.hpp"
#include "tests/support/pictures/stability.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

struct Settings {
    std::vector<std::string> clouds, methods{"paraboloid", "circle", "point"}, details{"auto"},
        motions{"orbit", "zoom", "parallel"}, distances{"1", "0.2"}, samples{"1"};
    std::optional<Shading> shading;
    ParameterValues parameters;
    int steps = 100, threads = 0;
    bool bruteForce = true;
};

Shading shadingOf(const std::string& word) {
    for (const Shading shading : {Shading::Unlit, Shading::Phong, Shading::EyeDome})
        if (word == scancast::name(shading)) return shading;
    std::fprintf(stderr, "bench_stability: no shading is called %s; example: --shading unlit\n",
                 word.c_str());
    std::exit(2);
}

void addParameter(const std::string& word, ParameterValues& parameters) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) {
        std::fprintf(stderr, "bench_stability: %s gives no value; example: --param gain=2\n", word.c_str());
        std::exit(2);
    }
    const std::string value = word.substr(equals + 1);
    ParameterValue& parameter = parameters[word.substr(0, equals)];
    if (value == "true" || value == "false")
        parameter = value == "true";
    else
        parameter = std::atof(value.c_str());
}

Settings parse(int argc, char** argv) {
    Settings s;
    readOptions(argc, argv,
                {{"--cloud", [&](const std::string& value) { s.clouds.push_back(value); }},
                 wordsOption("--method", s.methods),
                 wordsOption("--detail", s.details),
                 wordsOption("--motion", s.motions),
                 wordsOption("--distance", s.distances),
                 wordsOption("--samples", s.samples),
                 {"--shading", [&](const std::string& value) { s.shading = shadingOf(value); }},
                 {"--param", [&](const std::string& value) { addParameter(value, s.parameters); }},
                 countOption("--steps", s.steps, 1),
                 countOption("--threads", s.threads, 0),
                 flagOption("--no-brute-force", s.bruteForce, false)},
                "bench_stability --cloud town:2000000");
    if (s.clouds.empty()) s.clouds = {"town:2000000"};
    return s;
}

void printRow(Device& device, const Cloud& cloud, const std::string& cloudName, const View& view,
              const std::string& motion, const std::string& distance, const Settings& settings) {
    test::StabilityOptions options;
    options.motion = motion == "orbit" ? test::Motion::Orbit : test::Motion::Zoom;
    options.step = motion == "orbit" ? 0.1 : 0.5;
    options.steps = settings.steps;
    options.bruteForce = settings.bruteForce;
    const test::Stability s = orExit(test::measureStability(device, cloud, view, options));
    const std::string detail =
        view.quality.detail ? std::to_string(*view.quality.detail).substr(0, 4) : std::string("auto");
    std::printf("%-22s %-11s %-5s %-9s %-5s %3d %6.2f %6.2f  %6.2f %6.2f  %6.3f %6.3f  %6.2f %5.1f\n",
                cloudName.c_str(), view.style.method.c_str(), detail.c_str(), motion.c_str(),
                distance.c_str(), *view.quality.samples, 100 * s.frames.mean(), 100 * s.frames.worst,
                100 * s.bruteForce.mean(), 100 * s.bruteForce.worst, 100 * s.levels.mean(),
                100 * s.levels.worst, s.samples.mean() / 1e6, s.milliseconds.mean());
    std::fflush(stdout);
}

View viewOf(const Cloud& cloud, const std::string& motion, const std::string& distance,
            const Settings& settings) {
    View view = defaultView(cloud);
    Camera& camera = view.camera;
    const double factor = std::atof(distance.c_str());
    aimFrom(factor, cloud, camera);
    camera.viewHeight =
        2 * factor * glm::length(camera.eye - camera.target) * std::tan(glm::radians(camera.fov) / 2);
    if (motion == "parallel")
        camera.projection = Projection::Orthographic;
    else
        camera.eye = camera.target + (camera.eye - camera.target) * factor;
    if (settings.shading) view.style.shading = settings.shading;
    view.style.parameters = settings.parameters;
    return view;
}

void measure(Device& device, const Cloud& cloud, const std::string& name, const Settings& settings) {
    for (const std::string& method : settings.methods)
        for (const std::string& detail : settings.details)
            for (const std::string& motion : settings.motions)
                for (const std::string& distance : settings.distances)
                    for (const std::string& samples : settings.samples) {
                        View view = viewOf(cloud, motion, distance, settings);
                        view.style.method = method;
                        view.quality.samples = std::atoi(samples.c_str());
                        if (detail != "auto") view.quality.detail = std::atof(detail.c_str());
                        printRow(device, cloud, name, view, motion, distance, settings);
                    }
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    const auto device = orExit(createCpuDevice(settings.threads));
    std::shared_ptr<BlockCache> cache;
    std::printf(
        "Pixels that change by more than 16 of 255 from picture to picture, %%; 1280 x 720.\n"
        "                                                             levels on      brute force   levels "
        "alone  "
        " samples\n"
        "cloud                  method      tau   motion    dist    n   mean  worst    mean  worst    mean  "
        "worst  "
        "million    ms\n");
    for (const std::string& name : settings.clouds) {
        const auto cloud = measuredCloud(name, settings.threads, SCANCAST_BIN_DIR, cache);
        measure(*device, *cloud, name.substr(name.rfind('/') + 1), settings);
    }
    return 0;
}
