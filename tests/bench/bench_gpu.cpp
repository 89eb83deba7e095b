// The benchmark of a graphics card, by one command on a machine that has nothing but a driver: makes its
// clouds in memory, draws every method at three sizes, and sets each figure beside those of the papers and
// the marks of this project. Prints Markdown for docs/performance.md, row by row; gpu_day.sh runs it in parts
// of a few minutes.
//
//   bench_gpu [--backend egl|osmesa|cpu] [--egl-device N] [--require-hardware] [--sum-tiles true|false]
//             [--points 10M,100M,796M] [--scene town] [--no-surfels]
//             [--sizes 1248x768,1920x1080,3840x2160] [--methods …] [--repeat N] [--warm-up SECONDS]
//             [--compare [--anyway]] [--pictures FOLDER] [--json FILE] [--quick]
//
// host     the processor's work before the device begins: the stages select, provide and, where there is one,
// prepare GPU      all other stages but read-back, as the device's own clock tells them frame    from the
// view to the picture in main memory: selection, all passes, read-back JPEG     the same and its encoding
// (quality 90, 4:2:0) passes   what the device says of each stage; medians
//
// Each row begins with frames that are not counted: two, and more until --warm-up seconds have passed, since
// an idle card has slow clocks. Between frames the camera turns by 0.01 degrees, so that nothing can be
// reused. Every figure is a median of --repeat frames, or of what five seconds suffice for. One sample a
// pixel, each method at its own detail; "brute force" draws every point, without a hierarchy.
//
// --compare draws every row's picture with the cpu device, too, and does not time one that is below 45 dB.
//
// Exit codes: 0; 1 something failed, with a sentence; 2 wrong arguments; 3 no device opened; 4 it is no
// hardware
// (--require-hardware); 5 a picture is wrong (--compare).
#include "renderer/method/method.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/bench/gpu/clouds.hpp"
#include "tests/bench/gpu/open.hpp"
#include "tests/bench/gpu/report.hpp"
#include "tests/support/clouds/scene_clouds.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

struct Devices {
    std::unique_ptr<Device> measured;
    std::unique_ptr<Device> truth;  ///< the cpu device; none without --compare
};

void measureCloud(const Devices& devices, std::uint64_t points, const Settings& s, Report& report) {
    const BuiltForBench built = buildOrExit(s.scene, points, s.surfels);
    const Cloud& cloud = *built.cloud;
    report.beginCloud(cloud, built.seconds);
    for (const Size& size : s.sizes) {
        View view =
            test::sceneView(cloud, sceneViews(s.scene)[0], Projection::Perspective, size.width, size.height);
        const auto add = [&](const std::string& method, bool bruteForce) {
            view.style.method = method;
            report.add(measureRow(
                *devices.measured, devices.truth.get(), cloud, view,
                {.method = method, .bruteForce = bruteForce, .points = cloud.points, .size = size}, s));
        };
        add("point", true);
        for (const std::string& method : s.methods)
            if (s.surfels || findMethod(method)->needs == Needs::Points) add(method, false);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = settingsFrom(argc, argv);
    Devices devices{openOrExit(settings.device, settings.requireHardware), {}};
    if (settings.compare) devices.truth = orExit(createDevice({.backend = "cpu"}));
    Report report(devices.measured->info(), settings);
    for (const std::uint64_t points : settings.points) measureCloud(devices, points, settings, report);
    report.end();
    return report.wrongPictures() > 0 ? wrongPicture : 0;
}
