// How many normals point to the right side when nobody tells: scans whose own normals are dropped and found again
// (docs/spec/surfels.md §9), a line each.
//   bench_orientation kitten.xyz town:2M room:1M         (files with normals; scenes of the simulator)
//   bench_orientation --up scan.laz                      (no normals: everything that faces up or down faces up)
// right: of all samples of leaves; clear: of those whose normals are the same but for the side; sure: share in nodes
// that are drawn as oriented; wrong: of those, the ones that point to the wrong side: holes, where they are culled.
#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>

#include "renderer/cloud/import/open_scan.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/side_checks.hpp"

using namespace scancast;

namespace {

std::uint64_t pointsIn(const std::string& text) {
    const char unit = text.back();
    return std::uint64_t(std::stod(text) * (unit == 'M' ? 1e6 : unit == 'k' ? 1e3 : 1));
}

Expected<std::unique_ptr<PointSource>> open(const std::string& what) {
    if (std::filesystem::exists(what)) return openScan(what, {.importerDirectory = SCANCAST_BIN_DIR});
    const std::size_t colon = what.find(':');
    SceneOptions options;
    options.scene = what.substr(0, colon);
    options.points = colon == std::string::npos ? 300'000 : pointsIn(what.substr(colon + 1));
    return simulate(options);
}

Expected<std::shared_ptr<const Cloud>> build(const std::string& what, bool drop) {
    auto scan = open(what);
    if (!scan) return passOn(scan);
    BuildOptions options;
    options.shape.surfels = true;
    test::WithoutNormals without(**scan, !std::filesystem::exists(what));
    return buildCloud(drop ? static_cast<PointSource&>(without) : **scan, options);
}

glm::vec3 upwards(const Sample& sample) {
    const glm::vec3 n = decodeNormal(sample.normal);
    if (std::abs(n.z) < 0.3f) return glm::vec3(0);
    return n.z < 0 ? -n : n;
}

Expected<void> measure(const std::string& what, bool up) {
    const auto found = build(what, true);
    if (!found) return passOn(found);
    const auto side = [](const Node&, std::uint32_t, std::size_t, const Sample& s) { return upwards(s); };
    test::SideScore score;
    if (up) {
        score = test::scoreSides(**found, true, side);
    } else {
        const auto truth = build(what, false);
        if (!truth) return passOn(truth);
        score = test::scoreSides(**found, **truth);
    }
    fmt::print("{:<48} {:>9}  right {:7.3f} %  clear {:7.3f} %  sure {:6.2f} %  wrong {:7.4f} %\n",
               std::filesystem::path(what).filename().string(), score.samples, 100 * score.share(),
               score.clear ? 100.0 * double(score.clearRight) / double(score.clear) : 0,
               100 * score.sureShare(), 100 * score.wrongOfSure());
    std::fflush(stdout);
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    bool up = false;
    int failed = 0;
    for (int i = 1; i < argc; ++i) {
        if (std::string(argv[i]) == "--up") {
            up = true;
            continue;
        }
        if (const auto done = measure(argv[i], up); !done) {
            fmt::print(stderr, "{}\n", done.error().message);
            failed = 1;
        }
    }
    return failed;
}
