// Every method against the truth: generated scenes, whose surfaces are known, are drawn from their views
// (simulator/scenes/scene_views.cpp) in every method, without shading, and compared with the picture that
// rays through the scene itself give. Prints a Markdown table, one row a scene and method.
//
//   compare_methods [--scenes statue,town,…] [--methods paraboloid,ewa,…] [--points N] [--width N]
//                   [--steps N] [--repeat N] [--threads N] [--each-view] [--csv]
//
// PSNR, SSIM   of the picture as people get it (4 samples a pixel), background included; means over the views
// holes        background inside the scene's true silhouette less 2 px, per cent of its pixels
// turned       pixels that change by more than 16 of 255 when the camera orbits by 0.1°, per cent; mean of
//              --steps steps in the first view; in brackets the same steps drawn by brute force
// levels       the same, by changes of level alone, in the worst step
// ms           of a picture of one sample a pixel, all passes; medians, summed up from the passes'
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/ground_truth/ground_truth.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/picture_metrics.hpp"
#include "tests/support/pictures/stability.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

constexpr Rgb8 background{58, 66, 78};

struct Settings {
    std::vector<std::string> scenes, methods;
    std::uint64_t points = 0;  ///< 0: each scene's own
    int width = 1280, steps = 20, repeat = 5, threads = 0;
    bool eachView = false, csv = false;
};

/// So many that gaps are a few pixels wide from close by and none from afar: where methods differ.
constexpr std::pair<const char*, std::uint64_t> ownPoints[] = {
    {"statue", 600'000}, {"cube", 100'000},     {"torus", 100'000},  {"sign", 100'000},
    {"plane", 60'000},   {"bridge", 1'000'000}, {"town", 4'000'000},
};

Settings parse(int argc, char** argv) {
    Settings s;
    readOptions(argc, argv,
                {wordsOption("--scenes", s.scenes),
                 wordsOption("--methods", s.methods),
                 {"--points",
                  [&](const std::string& value) { s.points = std::strtoull(value.c_str(), nullptr, 10); }},
                 countOption("--width", s.width, 16),
                 countOption("--steps", s.steps, 0),
                 countOption("--repeat", s.repeat, 1),
                 countOption("--threads", s.threads, 0),
                 flagOption("--each-view", s.eachView),
                 flagOption("--csv", s.csv)},
                "compare_methods --scenes sign,cube");
    if (s.scenes.empty())
        for (const auto& [scene, points] : ownPoints) s.scenes.emplace_back(scene);
    if (s.methods.empty())
        for (const Method& method : methods())
            if (method.name != automaticName) s.methods.push_back(method.name);
    return s;
}

/// A view of a scene and the truth of it.
struct Target {
    std::string name;
    View view;
    Frame truth;
    PixelMask silhouette;
};

struct Subject {
    std::string scene;
    std::shared_ptr<const Cloud> cloud;
    std::vector<Target> targets;
};

Target targetOf(const SceneView& from, const Cloud& cloud, const RayCaster& caster, const Settings& s) {
    Target target;
    target.name = from.name;
    View& view = target.view = defaultView(cloud, s.width, s.width * 9 / 16);
    view.camera = test::cameraOf(from);
    view.style.shading = Shading::Unlit;
    view.style.exposure = 0;  // the truth is as bright as the scene
    view.style.background = {Background::Kind::Color, background, background};
    const Viewpoint viewpoint = orExit(Viewpoint::create(view, cloud.origin, cloud.bounds));
    const GroundTruth truth = orExit(
        castRays(caster, viewpoint, {.supersampling = 2, .cloudOrigin = cloud.origin, .threads = s.threads}));
    target.truth = truth.frame(background);
    target.silhouette = truth.silhouette();
    return target;
}

Subject subjectOf(const std::string& scene, const Settings& s) {
    SceneOptions options;
    options.scene = scene;
    options.origin = glm::dvec3(0);
    for (const auto& [name, points] : ownPoints)
        if (scene == name) options.points = points;
    if (s.points > 0) options.points = s.points;
    options.threads = s.threads;
    BuildOptions build;
    build.threads = s.threads;
    build.shape.surfels = true;
    build.mirrors = sceneMirrors(options);
    Subject subject{scene, orExit(buildCloud(*orExit(simulate(options)), build)), {}};
    const RayCaster caster = orExit(RayCaster::create(options));
    for (const SceneView& from : sceneViews(scene))
        subject.targets.push_back(targetOf(from, *subject.cloud, caster, s));
    if (!s.csv)
        std::fprintf(stderr, "%s: %llu points, %zu views\n", scene.c_str(),
                     static_cast<unsigned long long>(options.points), subject.targets.size());
    return subject;
}

/// Sums over views.
struct Score {
    int views = 0;
    double psnr = 0, ssim = 0;
    Holes holes;
    std::vector<StageTime> stages;  ///< medians of each view

    double milliseconds() const {
        double sum = 0;
        for (const StageTime& stage : stages) sum += stage.milliseconds / views;
        return sum;
    }
};

void addTimes(Device& device, const Cloud& cloud, View view, int repeat, Score& score) {
    view.quality.samples = 1;
    StageTimes times;
    for (int i = 0; i < repeat; ++i) times.add(orExit(render(device, cloud, view)).stats.stages);
    for (const StageTime& stage : times.medians()) {
        const auto same = std::ranges::find(score.stages, stage.name, &StageTime::name);
        if (same == score.stages.end())
            score.stages.push_back(stage);
        else
            same->milliseconds += stage.milliseconds;
    }
}

void add(Device& device, const Cloud& cloud, const Target& target, const std::string& method, int repeat,
         Score& score) {
    View view = target.view;
    view.style.method = method;
    const Frame picture = orExit(render(device, cloud, view));
    const auto holes = countHoles(picture, target.silhouette, 2).value_or(Holes{});
    ++score.views;
    score.psnr += psnr(picture, target.truth).value_or(0);
    score.ssim += ssim(picture, target.truth).value_or(0);
    score.holes.pixels += holes.pixels;
    score.holes.counted += holes.counted;
    addTimes(device, cloud, view, repeat, score);
}

void printHead(const Settings& s) {
    if (s.csv)
        std::printf(
            "scene,method,psnr,ssim,holes_percent,turned,turned_brute_force,levels_worst,ms,passes\n");
    else
        std::printf(
            "| scene | method | PSNR, dB | SSIM | holes, %% | turned, %% (brute force) | levels, %% | ms | "
            "of "
            "these |\n|---|---|---|---|---|---|---|---|---|\n");
    std::fflush(stdout);
}

void printRow(const std::string& scene, const std::string& method, const Score& score,
              const test::Stability& stability, const Settings& s) {
    std::string passes;
    for (const StageTime& stage : score.stages) {
        char text[64];
        std::snprintf(text, sizeof text, "%s%s %.1f", passes.empty() ? "" : (s.csv ? "; " : ", "),
                      stage.name.c_str(), stage.milliseconds / score.views);
        passes += text;
    }
    std::printf(s.csv ? "%s,%s,%.2f,%.4f,%.4f,%.3f,%.3f,%.3f,%.2f,%s\n"
                      : "| %s | `%s` | %.2f | %.4f | %.3f | %.2f (%.2f) | %.2f | %.1f | %s |\n",
                scene.c_str(), method.c_str(), score.psnr / score.views, score.ssim / score.views,
                100 * score.holes.part(), 100 * stability.frames.mean(), 100 * stability.bruteForce.mean(),
                100 * stability.levels.worst, score.milliseconds(), passes.c_str());
    std::fflush(stdout);
}

void compare(Device& device, const Subject& subject, const std::string& method, const Settings& s) {
    Score score;
    for (const Target& target : subject.targets) {
        Score one;
        add(device, *subject.cloud, target, method, s.repeat, s.eachView ? one : score);
        if (s.eachView) printRow(subject.scene + " " + target.name, method, one, {}, s);
    }
    if (s.eachView) return;
    View view = subject.targets.front().view;
    view.style.method = method;
    view.quality.samples = 1;
    const test::Stability stability =
        orExit(test::measureStability(device, *subject.cloud, view, {.steps = s.steps}));
    printRow(subject.scene, method, score, stability, s);
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    const auto device = orExit(createCpuDevice(settings.threads));
    printHead(settings);
    for (const std::string& scene : settings.scenes) {
        const Subject subject = subjectOf(scene, settings);
        if (subject.targets.empty()) {
            std::fprintf(stderr, "compare_methods: %s has no views to compare in\n", scene.c_str());
            return 1;
        }
        for (const std::string& method : settings.methods) compare(*device, subject, method, settings);
    }
    return 0;
}
