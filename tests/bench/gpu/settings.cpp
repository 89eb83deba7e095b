#include "tests/bench/gpu/settings.hpp"

#include <CLI/CLI.hpp>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "simulator/scene.hpp"
#include "simulator/write/point_count.hpp"

namespace scancast::bench {
namespace {

[[noreturn]] void refuse(const std::string& sentence) {
    std::fprintf(stderr, "%s\n", sentence.c_str());
    std::exit(2);
}

Size sizeFrom(const std::string& word) {
    Size size;
    if (std::sscanf(word.c_str(), "%dx%d", &size.width, &size.height) == 2 && size.width > 0 &&
        size.height > 0)
        return size;
    refuse("--sizes: '" + word + "' is no size; example: 1920x1080");
}

std::uint64_t pointsFrom(const std::string& word) {
    const auto points = parsePointCount(word);
    if (!points) refuse("--points: " + points.error().message);
    return *points;
}

template <class T, class Parse>
std::vector<T> parsed(const std::vector<std::string>& words, const Parse& parse) {
    std::vector<T> all;
    for (const std::string& word : words) all.push_back(parse(word));
    return all;
}

}  // namespace

Settings settingsFrom(int argc, char** argv) {
    Settings s;
    std::vector<std::string> points, sizes, names;
    for (const Method& method : methods()) {
        names.push_back(method.name);
        if (method.name != automaticName) s.methods.push_back(method.name);
    }
    bool noSurfels = false, quick = false;
    CLI::App app("Measures a graphics card with every method; prints Markdown");
    app.add_option("--backend", s.device.backend, "egl, osmesa, cpu");
    app.add_option("--egl-device", s.device.eglDevice, "as scancast --list-backends numbers them");
    app.add_option("--sum-tiles", s.device.sumTiles,
                   "whether sums are added up in shared memory first: true, false");
    app.add_flag("--require-hardware", s.requireHardware, "ends with exit code 4 on a software rasteriser");
    app.add_option("--points", points, "of the clouds: 10M,100M,796M")->delimiter(',');
    app.add_option("--scene", s.scene, "as scancast generate knows them");
    app.add_option("--sizes", sizes, "of the pictures: 1920x1080,...")->delimiter(',');
    app.add_option("--methods", s.methods, "of all methods")->delimiter(',')->check(CLI::IsMember(names));
    const auto* repeat =
        app.add_option("--repeat", s.repeat, "frames that are counted")->check(CLI::Range(1, 10000));
    const auto* warmUp = app.add_option("--warm-up", s.warmUp, "seconds of frames before each row")
                             ->check(CLI::Range(0.0, 60.0));
    app.add_flag("--no-surfels", noSurfels, "clouds without surfels, which are quicker to build");
    app.add_flag("--compare", s.compare, "each picture with the cpu device's; wrong ones are not timed");
    app.add_flag("--anyway", s.anyway, "times wrong pictures, too");
    app.add_option("--pictures", s.pictures, "folder for a PNG of each row of the first size");
    app.add_option("--json", s.json, "file for the figures; complete after every row");
    app.add_flag("--quick", quick, "tiny numbers: shows that everything runs, and nothing else");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error) == 0 ? 0 : 2);
    }
    if (quick) {
        s.points = {10'000};
        s.sizes = {{320, 192}};
        if (repeat->count() == 0) s.repeat = 1;
        if (warmUp->count() == 0) s.warmUp = 0;
    }
    if (!points.empty()) s.points = parsed<std::uint64_t>(points, pointsFrom);
    if (!sizes.empty()) s.sizes = parsed<Size>(sizes, sizeFrom);
    s.surfels = !noSurfels;
    if (sceneViews(s.scene).empty()) refuse("--scene: there is none named '" + s.scene + "'; example: town");
    return s;
}

}  // namespace scancast::bench
