// Discs and ellipses against the straightforward renderer in double: two implementations that share no code
// agree only if both follow docs/spec/surfels.md §3 and docs/spec/voronoi.md §2. They may differ where
// rounding decides: a pixel centre on an outline, a depth at a tolerance's end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_surfels.hpp"
#include "tests/support/pictures/reference_surfels.hpp"

namespace scancast::test {
namespace {

/// Surfels of every kind, from very near to far: tilted any way, of any size, ellipses, without a normal,
/// without a radius, outliers.
AnalyticCloud mixture() {
    Numbers numbers(51);
    std::vector<AnalyticPoint> points(9000);
    for (AnalyticPoint& p : points) {
        const glm::dvec3 outward = numbers.onSphere();
        p.position = outward * numbers.uniform(0.4, 6.0) + glm::dvec3(1, 2, 0.5);
        p.rgb = numbers.color();
        const glm::dvec3 normal = numbers.onSphere();
        const double radius = 0.1 * std::exp2(numbers.uniform(-3, 0.5));
        const glm::dvec3 major = glm::normalize(glm::cross(normal, numbers.onSphere()));
        Surfel s = surfelOf(normal, radius, major, numbers.uniform(0.25, 1));
        const double kind = numbers.uniform();
        if (kind < 0.05) s.normal = s.majorAxis = glm::vec3(0);
        if (kind > 0.95) s.radius = 0;
        s.outlier = kind > 0.4 && kind < 0.42;
        p.surfel = s;
    }
    return {points, 0.05, 700};
}

struct Setting {
    const char* name;
    Viewpoint view;
};

std::vector<Setting> settings() {
    return {{"inside the cloud", lookAt({1.2, 1.5, 0.3}, {3, 4, 1}, 317, 203, 75, 0.05)},
            {"from far", lookAt({-30, -20, 9}, {1, 2, 0.5}, 640, 360, 25, 0.05)},
            {"wide angle", lookAt({-3, 1, 2}, {1, 2, 0.5}, 256, 256, 125, 0.2)},
            {"orthographic", lookAtOrthographic({-8, -5, 3}, {1, 2, 0.5}, 317, 203, 9)},
            {"orthographic, close", lookAtOrthographic({1, 2, 0.5}, {3, 4, 1}, 200, 320, 2.5)}};
}

Splat discs(float scale = 1) {
    Splat s;
    s.footprint = Footprint::Disc;
    s.size.scale = scale;
    s.size.maxPx = 60;
    return s;
}

Splat ellipses(float lowPass = 0.5f) {
    Splat s = discs();
    s.footprint = Footprint::Ellipse;
    s.lowPassPx = lowPass;
    return s;
}

Splat rounded(Splat s) {
    s.round = true;
    return s;
}

Splat turned(Splat s, Facing facing) {
    s.facing = facing;
    return s;
}

ResolvePass means() {
    ResolvePass pass;
    pass.sums = true;
    return pass;
}

double distance(const Rgb8& a, const glm::dvec3& b) {
    double most = 0;
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[static_cast<std::size_t>(c)] - b[c]));
    return most;
}

const glm::dvec2 someJitter{0.31, -0.22};

class SurfelReference : public OnDeviceWith<std::tuple<std::string, bool>> {
  protected:
    bool oriented() const { return std::get<1>(GetParam()); }

    /// Draws with every camera and hands every pixel of both pictures to `same`; 99.9 % must be.
    template <class Same>
    void compare(const char* what, const PassList& passes, const Same& same) {
        for (const Setting& setting : settings()) {
            SurfelScene scene(setting.view, cloud_.cut(), passes);
            scene.drawing.oriented = oriented();
            scene.drawing.jitter = {&someJitter, 1};
            const Frame frame = mustDraw(*device_, scene.drawing);
            const ReferenceSurfels reference = referenceSurfels(scene.drawing);
            std::size_t good = 0, drawn = 0;
            for (int y = 0; y < frame.height; ++y) {
                for (int x = 0; x < frame.width; ++x) {
                    const ReferencePixel& r = reference.at(x, y);
                    const bool empty = r.depth == ReferencePixel::none;
                    drawn += empty ? 0 : 1;
                    const double d = depth(frame, x, y);
                    const bool sameDepth =
                        empty ? std::isinf(d) : std::abs(d - r.depth) <= 2e-4 * r.depth + 2e-5;
                    good += sameDepth && (empty || same(pixel(frame, x, y), r, reference)) ? 1 : 0;
                }
            }
            const double all = double(frame.width) * frame.height;
            EXPECT_GE(double(good) / all, 0.999) << what << ", " << setting.name;
            EXPECT_GE(double(drawn) / all, 0.01) << what << ", " << setting.name;
        }
    }

    const AnalyticCloud cloud_ = mixture();
};

TEST_P(SurfelReference, NearestDiscs) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels& all) {
        return c == all.colors[r.nearest];
    };
    for (const Facing facing : {Facing::Any, Facing::Front, Facing::Back}) {
        if (facing == Facing::Back && !oriented()) continue;
        for (const float scale : {0.2f, 1.0f, 2.5f}) {
            NearestPass pass{turned(discs(scale), facing)};
            compare("discs", {pass, ResolvePass{}}, same);
            pass.payload = Payload::Sample;
            compare("discs by ordinal", {pass, ResolvePass{}}, same);
        }
    }
}

TEST_P(SurfelReference, NearestEllipses) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels& all) {
        return c == all.colors[r.nearest];
    };
    for (const float lowPass : {0.1f, 0.5f, 1.5f}) {
        compare("ellipses", {NearestPass{ellipses(lowPass)}, ResolvePass{}}, same);
    }
    compare("circles", {NearestPass{rounded(ellipses())}, ResolvePass{}}, same);
}

TEST_P(SurfelReference, BlendedDiscs) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels&) {
        return distance(c, r.color / r.weight) <= 1.0;
    };
    compare("blended discs", {NearestPass{discs()}, CellPass{discs()}, SumPass{discs()}, means()}, same);
    SumPass near{discs()};
    near.reach = 1;
    compare("blended discs, not extended", {NearestPass{discs()}, CellPass{discs()}, near, means()}, same);
}

TEST_P(SurfelReference, BlendedEllipses) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels&) {
        return distance(c, r.color / r.weight) <= 1.0;
    };
    for (const float lowPass : {0.1f, 0.5f, 1.5f}) {
        const Splat splat = ellipses(lowPass);
        compare("blended ellipses", {NearestPass{splat}, SumPass{splat}, means()}, same);
    }
    const Splat circles = rounded(ellipses());
    compare("blended circles", {NearestPass{circles}, SumPass{circles}, means()}, same);
}

TEST_P(SurfelReference, Cells) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels& all) {
        // Where nothing lies within the tolerance, the background shows.
        return r.distance == ReferencePixel::none || c == all.colors[r.cell];
    };
    for (const float tolerance : {0.25f, 0.5f, 1.0f}) {
        CellPass cell{discs()};
        cell.tolerance = tolerance;
        compare("cells", {NearestPass{discs()}, cell, ResolvePass{}}, same);
    }
}

TEST_P(SurfelReference, Silhouettes) {
    const auto same = [](const Rgb8& c, const ReferencePixel& r, const ReferenceSurfels& all) {
        return r.distance == ReferencePixel::none || c == all.colors[r.cell];
    };
    const Splat front = turned(discs(), Facing::Front);
    compare(
        "silhouette",
        {SilhouettePass{turned(discs(), Facing::Back)}, NearestPass{front}, CellPass{front}, ResolvePass{}},
        same);
}

const auto instanceName = [](const auto& p) {
    return std::get<0>(p.param) + (std::get<1>(p.param) ? "_oriented" : "_unoriented");
};
INSTANTIATE_TEST_SUITE_P(Cpu, SurfelReference, testing::Combine(testing::Values("cpu"), testing::Bool()),
                         instanceName);
INSTANTIATE_TEST_SUITE_P(Gl, SurfelReference, testing::Combine(testing::Values("egl"), testing::Bool()),
                         instanceName);

}  // namespace
}  // namespace scancast::test
