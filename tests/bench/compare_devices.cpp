// Every device against the cpu device: generated scenes are drawn in every method and both projections, at
// full quality but one sample a pixel, and compared byte by byte. Prints a table, one row a method, scene and
// projection.
//
//   compare_devices [--backends egl,osmesa] [--require-hardware] [--scenes town,statue,…]
//                   [--methods paraboloid,ewa,…] [--points N] [--width N] [--repeat N] [--threads N]
//                   [--markdown] [--json FILE]
//
// dB        PSNR of all four channels against the cpu device's picture; inf = the same bytes
// changed   pixels of which a byte differs, and of which the depth's bits differ
// ms        of a frame, all passes, from the view to the picture in main memory; median
//
// Ends with a line a backend: how many pictures are the cpu device's bytes, and the least alike. gpu_day.sh
// asks this first of a graphics card, so that no wrong picture is timed.
//
// Exit codes: 0; 1 something failed, with a sentence; 3 a backend does not open; 4 it is no hardware
// (--require-hardware); 5 a picture is below 45 dB, which is what devices owe each other.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/bench/gpu/open.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/agreement.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

struct Settings {
    std::vector<std::string> backends{"egl", "osmesa"};
    std::vector<std::string> scenes{"town", "statue", "sign", "cube", "torus", "bridge"};
    std::vector<std::string> methods;
    std::uint64_t points = 200'000;
    int width = 640, repeat = 3, threads = 0;
    bool markdown = false, requireHardware = false;
    std::string json;  ///< file; empty = none
};

struct Subject {
    std::string name;
    std::unique_ptr<Device> device;
    int pictures = 0, sameBytes = 0;
    double leastAlike = std::numeric_limits<double>::infinity();  ///< dB

    bool agrees() const { return leastAlike >= owedDecibels; }
};

Subject open(const std::string& backend, int threads, bool requireHardware) {
    DeviceOptions options;
    options.backend = backend;
    options.threads = threads;
    Subject subject{backend, openOrExit(options, requireHardware)};
    const DeviceInfo info = subject.device->info();
    std::printf("%s: %s %s, %s\n", backend.c_str(), info.vendor.c_str(), info.renderer.c_str(),
                info.version.c_str());
    return subject;
}

struct Drawn {
    Frame frame;
    double milliseconds = 0;
};

/// The last of some pictures; the first one compiles and uploads, and is not counted.
Drawn drawn(Device& device, const Cloud& cloud, const View& view, int repeat) {
    Drawn result;
    std::vector<double> times;
    for (int i = 0; i <= repeat; ++i) {
        const double took = timed([&] { result.frame = orExit(render(device, cloud, view)); });
        if (i > 0) times.push_back(took);
    }
    result.milliseconds = median(times);
    return result;
}

void printHead(const Settings& s) {
    const auto row = [&](const char* first, const char* each) {
        std::printf("%s", first);
        for (const std::string& backend : s.backends) std::printf(each, backend.c_str(), backend.c_str());
        std::printf("\n");
    };
    if (s.markdown) {
        row("| method | scene | projection | cpu, ms |", " %s, dB | changed, depths | %s, ms |");
        row("|---|---|---|---|", "---|---|---|");
    } else {
        row("method      scene   projection     cpu ms", "  %9s dB  changed  depths  %6s ms");
    }
}

void printAgreement(const test::Agreement& a, double milliseconds, const Settings& s) {
    std::printf(s.markdown ? " %.1f | %zu, %zu | %.1f |" : "  %12.1f  %7zu  %6zu  %9.1f", a.psnr, a.changed,
                a.changedDepth, milliseconds);
}

nlohmann::ordered_json jsonOf(const std::string& backend, const std::string& scene, const View& view,
                              const test::Agreement& a) {
    return {{"backend", backend},
            {"method", view.style.method},
            {"scene", scene},
            {"projection", name(view.camera.projection)},
            {"width", view.width},
            {"height", view.height},
            {"sameBytes", a.identical()},
            // Infinite where all colours are the same; JSON has no such number.
            {"psnrDb", std::isfinite(a.psnr) ? nlohmann::ordered_json(a.psnr) : nlohmann::ordered_json()},
            {"pixelsChanged", a.changed},
            {"depthsChanged", a.changedDepth}};
}

/// Appends to `json`, and to what each device is remembered for.
void compareRow(std::vector<Subject>& devices, const Cloud& cloud, const View& view, const std::string& scene,
                const Settings& s, nlohmann::ordered_json& json) {
    const std::string projection(name(view.camera.projection));
    const Drawn truth = drawn(*devices[0].device, cloud, view, s.repeat);
    std::printf(s.markdown ? "| `%s` | %s | %s | %.1f |" : "%-10s  %-6s  %-12s  %7.1f",
                view.style.method.c_str(), scene.c_str(), projection.c_str(), truth.milliseconds);
    for (std::size_t i = 1; i < devices.size(); ++i) {
        const Drawn other = drawn(*devices[i].device, cloud, view, s.repeat);
        const test::Agreement agreement = test::agreementOf(truth.frame, other.frame);
        printAgreement(agreement, other.milliseconds, s);
        ++devices[i].pictures;
        devices[i].sameBytes += agreement.identical();
        devices[i].leastAlike = std::min(devices[i].leastAlike, agreement.psnr);
        json.push_back(jsonOf(devices[i].name, scene, view, agreement));
    }
    std::printf("\n");
    std::fflush(stdout);
}

void save(const nlohmann::ordered_json& json, const std::string& name) {
    if (name.empty()) return;
    std::ofstream file(name);
    file << json.dump(1) << '\n';
    if (file.flush()) return;
    std::fprintf(stderr, "%s could not be written.\n", name.c_str());
    std::exit(1);
}

/// Whether all of them agree.
bool printSummary(const std::vector<Subject>& devices) {
    bool good = true;
    std::printf("\n");
    for (const Subject& device : std::span(devices).subspan(1)) {
        std::printf(
            "%s: %d of %d pictures are the cpu device's bytes, the least alike is %.1f dB from it%s\n",
            device.name.c_str(), device.sameBytes, device.pictures, device.leastAlike,
            device.agrees() ? "." : ": **NOT ALL AGREE**.");
        good &= device.agrees();
    }
    return good;
}

Settings parse(int argc, char** argv) {
    Settings s;
    for (const Method& method : methods())
        if (method.name != automaticName) s.methods.push_back(method.name);
    CLI::App app("Compares pictures of the GL devices with those of the cpu device");
    app.add_option("--backends", s.backends, "egl, osmesa")->delimiter(',');
    app.add_option("--scenes", s.scenes, "as scancast generate knows them")->delimiter(',');
    app.add_option("--methods", s.methods, "of all methods")->delimiter(',');
    app.add_option("--points", s.points, "of each scene")->check(CLI::PositiveNumber);
    app.add_option("--width", s.width, "px; the height is 9/16 of it")->check(CLI::Range(16, 4096));
    app.add_option("--repeat", s.repeat, "pictures that are timed")->check(CLI::Range(1, 1000));
    app.add_option("--threads", s.threads, "of the cpu device; 0 = all cores");
    app.add_flag("--require-hardware", s.requireHardware, "ends with exit code 4 on a software rasteriser");
    app.add_option("--json", s.json, "file for the figures");
    app.add_flag("--markdown", s.markdown, "for docs/performance.md");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error) == 0 ? 0 : 2);
    }
    return s;
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    std::vector<Subject> devices;
    devices.push_back(open("cpu", settings.threads, false));
    for (const std::string& backend : settings.backends)
        devices.push_back(open(backend, settings.threads, settings.requireHardware));
    std::printf("%llu points a scene, %d x %d px\n\n", static_cast<unsigned long long>(settings.points),
                settings.width, settings.width * 9 / 16);
    printHead(settings);
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const std::string& scene : settings.scenes) {
        const auto cloud = orExit(test::sceneCloud(scene, settings.points));
        for (const std::string& method : settings.methods) {
            for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
                View view = test::sceneView(*cloud, sceneViews(scene)[0], projection, settings.width,
                                            settings.width * 9 / 16);
                view.style.method = method;
                compareRow(devices, *cloud, view, scene, settings, json);
            }
        }
        save(json, settings.json);
    }
    return printSummary(devices) ? 0 : wrongPicture;
}
