// The benchmark of a graphics card, by one command on a machine that has nothing but a driver: makes its
// clouds in memory, draws every method at three sizes, and sets the figures beside those of the papers and
// the marks of this project. Prints Markdown for docs/performance.md.
//
//   bench_gpu [--backend egl|osmesa|cpu] [--egl-device N] [--points 10M,100M,1G] [--scene town]
//             [--sizes 1248x768,1920x1080,3840x2160] [--methods …] [--repeat N] [--no-surfels] [--quick]
//
// frame    from the view to the picture in main memory: selection, all passes, read-back
// JPEG     the same and its encoding (quality 90, 4:2:0)
// passes   what the device says of each pass; medians
//
// Between frames the camera turns by 0.01 degrees, so that nothing can be reused. Every figure is a median of
// --repeat frames after two that are not counted, which upload and compile. One sample a pixel, each method
// at its own detail; "brute force" draws every point, without a hierarchy. A town of 1000 million points
// takes, by estimate, 40 GB of memory and some minutes to build: --points leaves it out.
#include <CLI/CLI.hpp>

#include "renderer/image/encode.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "renderer/simulate/write/point_count.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/support/scene_clouds.hpp"
#include "tests/support/stability.hpp"

namespace {

using namespace scancast;
using namespace scancast::bench;

struct Size {
    int width = 0, height = 0;
};

struct Settings {
    DeviceOptions device{.backend = "egl"};
    std::string scene = "town";
    std::vector<std::uint64_t> points{10'000'000, 100'000'000, 1'000'000'000};
    std::vector<Size> sizes{{1248, 768}, {1920, 1080}, {3840, 2160}};
    std::vector<std::string> methods;
    int repeat = 30;
    bool surfels = true;
};

/// Medians of some frames.
struct Cost {
    std::vector<StageTime> stages;
    double frame = 0, jpeg = 0;
    std::uint64_t samples = 0;

    /// Of the named stages together.
    double of(std::initializer_list<std::string_view> names) const {
        double sum = 0;
        for (const StageTime& stage : stages)
            if (std::ranges::find(names, stage.name) != names.end()) sum += stage.milliseconds;
        return sum;
    }
};

Cost measure(Device& device, const Cloud& cloud, View view, const RenderOptions& options, int repeat) {
    Cost cost;
    StageTimes stages;
    std::vector<double> frames, jpegs;
    for (int i = 0; i < repeat + 2; ++i) {
        view.camera = test::moved(view.camera, test::Motion::Orbit, 0.01);
        Frame frame;
        const double drawing = timed([&] { frame = orExit(render(device, cloud, view, options)); });
        const double encoding = timed([&] { orExit(encodeJpeg(frame, 90, Subsampling::S420)); });
        if (i < 2) continue;
        frames.push_back(drawing);
        jpegs.push_back(drawing + encoding);
        stages.add(frame.stats.stages);
        cost.samples = frame.stats.samplesDrawn;
    }
    cost.stages = stages.medians();
    cost.frame = median(frames);
    cost.jpeg = median(jpegs);
    return cost;
}

std::string text(const std::vector<StageTime>& stages) {
    std::string all;
    for (const StageTime& stage : stages) {
        char one[80];
        std::snprintf(one, sizeof one, "%s%s %.3f", all.empty() ? "" : ", ", stage.name.c_str(),
                      stage.milliseconds);
        all += one;
    }
    return all;
}

void printRow(const std::string& method, const Size& size, const Cost& cost) {
    std::printf("| %s | %d x %d | %.2f | %.2f | %.2f | %s |\n", method.c_str(), size.width, size.height,
                double(cost.samples) / 1e6, cost.frame, cost.jpeg, text(cost.stages).c_str());
    std::fflush(stdout);
}

/// A figure of this run beside what was promised or published.
struct Mark {
    std::string what, wanted;
    double measured = 0;  ///< ms
};

/// What the marks are about, picked from all that is measured.
void collect(std::vector<Mark>& marks, const std::string& method, std::uint64_t points, const Size& size,
             bool bruteForce, const Cost& cost) {
    const std::string of = std::to_string(points / 1'000'000) + " million points, ";
    const bool papers = size.width == 1248 && size.height == 768, fullHd = size.width == 1920;
    if (method == "pyramid" && papers && !bruteForce) {
        marks.push_back({of + "`pyramid`, its screen passes, 1248 x 768", "<= 0.6 (mark)",
                         cost.of({"hidden points", "pull-push", "normals", "phong"})});
        marks.push_back({of + "hidden point removal, 1248 x 768", "2.1-2.7 (GTX 1080, paper 004)",
                         cost.of({"hidden points"})});
        marks.push_back(
            {of + "geometry pass, 1248 x 768", "1.4-11.4 (GTX 1080, paper 004)", cost.of({"nearest"})});
    }
    if (method == "point" && bruteForce && fullHd) {
        marks.push_back({of + "without a hierarchy, `point`, 1080p",
                         points == 100'000'000 ? "<= 8 (mark)" : "796 million in 16.1 (RTX 3090)",
                         cost.frame});
    }
    if (fullHd && !bruteForce)
        marks.push_back({of + "`" + method + "`, view to JPEG, 1080p", "<= 10 (mark)", cost.jpeg});
}

void measureCloud(Device& device, std::uint64_t points, const Settings& s, std::vector<Mark>& marks) {
    std::shared_ptr<const Cloud> cloud;
    const double built = timed([&] { cloud = orExit(test::sceneCloud(s.scene, points, 16384, s.surfels)); });
    std::printf("\n### %s, %llu points (built in %.0f s)\n\n", s.scene.c_str(),
                static_cast<unsigned long long>(points), built / 1000);
    std::printf("| method | size | million samples | frame, ms | JPEG, ms | passes, ms |\n");
    std::printf("|---|---|---|---|---|---|\n");
    for (const Size& size : s.sizes) {
        View view =
            test::sceneView(*cloud, sceneViews(s.scene)[0], Projection::Perspective, size.width, size.height);
        const auto add = [&](const std::string& method, bool bruteForce) {
            view.style.method = method;
            const Cost cost = measure(device, *cloud, view, {.bruteForce = bruteForce}, s.repeat);
            printRow(bruteForce ? "`" + method + "`, brute force" : "`" + method + "`", size, cost);
            collect(marks, method, points, size, bruteForce, cost);
        };
        add("point", true);
        for (const std::string& method : s.methods) {
            if (s.surfels || findMethod(method)->needs == Needs::Points) add(method, false);
        }
    }
}

void printMarks(const std::vector<Mark>& marks) {
    std::printf(
        "\n### Against the papers and the marks\n\n| what | wanted, ms | measured, ms |\n|---|---|---|\n");
    for (const Mark& mark : marks)
        std::printf("| %s | %s | %.2f |\n", mark.what.c_str(), mark.wanted.c_str(), mark.measured);
}

template <class T, class Parse>
std::vector<T> parsed(const std::vector<std::string>& words, const Parse& parse) {
    std::vector<T> all;
    for (const std::string& word : words) all.push_back(parse(word));
    return all;
}

Size sizeFrom(const std::string& word) {
    Size size;
    if (std::sscanf(word.c_str(), "%dx%d", &size.width, &size.height) == 2 && size.width > 0 &&
        size.height > 0)
        return size;
    std::fprintf(stderr, "--sizes: '%s' is no size; example: 1920x1080\n", word.c_str());
    std::exit(2);
}

Settings parse(int argc, char** argv) {
    Settings s;
    std::vector<std::string> points, sizes, names;
    for (const Method& method : methods())
        if (method.name != automaticName) s.methods.push_back(method.name);
    for (const Method& method : methods()) names.push_back(method.name);
    bool noSurfels = false, quick = false;
    CLI::App app("Measures a graphics card with every method; prints Markdown");
    app.add_option("--backend", s.device.backend, "egl, osmesa, cpu");
    app.add_option("--egl-device", s.device.eglDevice, "as scancast --list-backends numbers them");
    app.add_option("--points", points, "of the clouds: 10M,100M,1G")->delimiter(',');
    app.add_option("--scene", s.scene, "as scancast generate knows them");
    app.add_option("--sizes", sizes, "of the pictures: 1920x1080,...")->delimiter(',');
    app.add_option("--methods", s.methods, "of all methods")->delimiter(',')->check(CLI::IsMember(names));
    app.add_option("--repeat", s.repeat, "frames that are counted")->check(CLI::Range(1, 10000));
    app.add_flag("--no-surfels", noSurfels, "clouds without surfels, which are quicker to build");
    app.add_flag("--quick", quick, "tiny numbers: shows that everything runs, and nothing else");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error));
    }
    if (quick) {
        s.points = {10'000};
        s.sizes = {{320, 192}};
        s.repeat = 1;
    }
    if (!points.empty())
        s.points =
            parsed<std::uint64_t>(points, [](const auto& word) { return orExit(parsePointCount(word)); });
    if (!sizes.empty()) s.sizes = parsed<Size>(sizes, sizeFrom);
    s.surfels = !noSurfels;
    return s;
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    if (sceneViews(settings.scene).empty()) {
        std::fprintf(stderr, "--scene: there is none named '%s'; example: town\n", settings.scene.c_str());
        return 2;
    }
    auto opened = createDevice(settings.device);
    if (!opened) {
        std::fprintf(stderr, "%s\n", opened.error().message.c_str());
        return 3;  // so that a test can tell
    }
    Device& device = **opened;
    const DeviceInfo info = device.info();
    std::printf("## %s\n\n%s, %s, %s%s; medians of %d frames, one sample a pixel.\n", info.name.c_str(),
                info.vendor.c_str(), info.renderer.c_str(), info.version.c_str(),
                info.hardware ? "" : " (software: no figures of a graphics card)", settings.repeat);
    std::vector<Mark> marks;
    for (const std::uint64_t points : settings.points) measureCloud(device, points, settings, marks);
    printMarks(marks);
    return 0;
}
