// How many normals point to the right side when nobody tells: scans whose own normals are dropped and found again
// (docs/spec/surfels.md §9), a line each.
//   bench_orientation kitten.xyz town:2M room:1M         (files with normals; scenes of the simulator)
//   bench_orientation office.pcd                         (no normals, but the place of the camera)
//   bench_orientation --up scan.laz                      (no normals: everything that faces up or down faces up)
// right: of all samples of leaves; clear: of those whose normals are the same but for the side; sure: share in nodes
// that are drawn as oriented; wrong: of those, the ones that point to the wrong side: holes, where they are culled. Of
// scenes, whose solids have faces inside each other, a second line for those that are seen at all: air that comes from
// outside, of a room from its middle, reaches the side that they look to.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

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

/// Cells that air gets to: from the border of the box, or from the middle. Cells with samples hold it back.
class Air {
  public:
    Air(const Cloud& cloud, bool fromMiddle) {
        std::vector<glm::dvec3> places;
        forEachLeafSample(cloud, [&](const glm::dvec3& p, double spacing) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
            cell_ = std::max(cell_, 2 * spacing);
            places.push_back(p);
        });
        const glm::dvec3 size = high_ - low_;
        cell_ = std::max(cell_, std::max({size.x, size.y, size.z}) / 300);
        low_ -= 2 * cell_;
        cells_ = glm::ivec3((size / cell_) + 5.0);
        state_.assign(std::size_t(cells_.x) * std::size_t(cells_.y) * std::size_t(cells_.z), Unknown);
        for (const glm::dvec3& p : places) state_[at(cellOf(p))] = Solid;
        spread(fromMiddle ? cells_ / 2 : glm::ivec3(0));
    }
    bool reaches(const glm::dvec3& place, const glm::vec3& side) const {
        const glm::dvec3 way = glm::dvec3(side) * cell_;
        return isAir(place + 1.8 * way) || isAir(place + 2.6 * way);
    }

  private:
    enum State : char { Unknown, Solid, Free };

    template <class F>
    static void forEachLeafSample(const Cloud& cloud, const F& f) {
        for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i) {
            const Node& node = cloud.octree.node(i);
            if (!node.isLeaf()) continue;
            const auto run = cloud.octree.run(i);
            for (const Sample& s : run->samples) f(glm::dvec3(position(node, s)), node.spacing);
        }
    }
    glm::ivec3 cellOf(const glm::dvec3& p) const { return glm::ivec3(glm::floor((p - low_) / cell_)); }
    bool holds(const glm::ivec3& c) const {
        return glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, cells_));
    }
    std::size_t at(const glm::ivec3& c) const {
        return (std::size_t(c.z) * std::size_t(cells_.y) + std::size_t(c.y)) * std::size_t(cells_.x) +
               std::size_t(c.x);
    }
    bool isAir(const glm::dvec3& p) const {
        const glm::ivec3 c = cellOf(p);
        return !holds(c) || state_[at(c)] == Free;
    }
    void spread(const glm::ivec3& from) {
        std::vector<glm::ivec3> open{from};
        state_[at(from)] = Free;
        while (!open.empty()) {
            const glm::ivec3 c = open.back();
            open.pop_back();
            for (int a = 0; a < 6; ++a) {
                glm::ivec3 next = c;
                next[a / 2] += a % 2 ? 1 : -1;
                if (!holds(next) || state_[at(next)] != Unknown) continue;
                state_[at(next)] = Free;
                open.push_back(next);
            }
        }
    }

    glm::dvec3 low_{1e300}, high_{-1e300};
    double cell_ = 0;
    glm::ivec3 cells_{0};
    std::vector<char> state_;
};

void print(const std::string& name, const test::SideScore& score) {
    fmt::print("{:<48} {:>9}  right {:7.3f} %  clear {:7.3f} %  sure {:6.2f} %  wrong {:7.4f} %\n", name,
               score.samples, 100 * score.share(),
               score.clear ? 100.0 * double(score.clearRight) / double(score.clear) : 0,
               100 * score.sureShare(), 100 * score.wrongOfSure());
    std::fflush(stdout);
}

Expected<void> measure(const std::string& what, bool up) {
    const auto found = build(what, true);
    if (!found) return passOn(found);
    const auto side = [](const Node&, std::uint32_t, std::size_t, const Sample& s) { return upwards(s); };
    const std::string name = std::filesystem::path(what).filename().string();
    if (up) {
        print(name, test::scoreSides(**found, true, side));
        return {};
    }
    const auto truth = build(what, false);
    if (!truth) return passOn(truth);
    print(name, test::scoreSides(**found, **truth));
    if (std::filesystem::exists(what)) return {};
    const Air air(**truth, what.starts_with("room"));
    const auto seen = [&](const Node& node, const Sample& sample, const glm::vec3& normal) {
        return air.reaches(glm::dvec3(position(node, sample)), normal);
    };
    print("  seen", test::scoreSides(**found, **truth, seen));
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
