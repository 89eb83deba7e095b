// The surface that pull-push and the normals of docs/spec/pyramid.md §6 make of points, against a sphere of
// which every ray and every normal is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "renderer/method/method.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/point_passes.hpp"

namespace scancast::test {
namespace {

class PyramidSurface : public OnPointPasses {};
SCANCAST_ON_DEVICES(PyramidSurface, "egl");

constexpr double degrees = 57.29577951308232;

struct SurfaceSetting {
    int width, height;
    bool perspective;
    double spacingPx;
};

std::string nameOf(const SurfaceSetting& s) {
    return std::to_string(s.width) + " x " + std::to_string(s.height) + ", every " +
           std::to_string(s.spacingPx) + " px, " + (s.perspective ? "perspective" : "orthographic");
}

std::vector<SurfaceSetting> surfaceSettings(bool small) {
    std::vector<SurfaceSetting> all;
    for (const auto& [width, height] : {std::pair{640, 480}, {1248, 768}, {333, 301}}) {
        if (small && width > 333) continue;
        for (const bool perspective : {true, false}) {
            for (const double spacing : {1.5, 2.0, 2.5, 3.0, 3.5}) {
                all.push_back({width, height, perspective, spacing});
            }
        }
    }
    return all;
}

/// Distance from the eye to the unit sphere's middle.
constexpr double distance = 3;

struct SpherePicture {
    PointScreen screen;
    double spacing, silhouettePx;
};

/// Points evenly spread by the golden angle; `spacingPx` where the sphere is nearest.
SpherePicture sphere(const SurfaceSetting& s) {
    const double pixels = s.perspective ? 1.1 * s.height : 0.4 * s.height;
    SpherePicture p{{s.width, s.height, s.perspective, pixels}, 0, 0};
    p.spacing = s.spacingPx * (s.perspective ? distance - 1 : 1) / pixels;
    p.silhouettePx = pixels * (s.perspective ? 1 / std::sqrt(distance * distance - 1) : 1);
    const int count = static_cast<int>(4 * 3.14159265358979 / (p.spacing * p.spacing));
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
        p.screen.add({r * std::cos(angle), r * std::sin(angle), distance - z}, 0, 0xff8040c0);
    }
    return p;
}

/// Where a pixel's ray meets the sphere first, and how much it faces the viewer there.
struct Hit {
    glm::dvec3 normal;
    double depth, facing;
};

Hit hitAt(const PointScreen& s, int x, int y) {
    const ScreenPoint ray = s.through(x, y);
    if (!s.perspective) {
        const double z = std::sqrt(std::max(0.0, 1 - ray.x * ray.x - ray.y * ray.y));
        return {{ray.x, ray.y, z}, distance - z, z};
    }
    const glm::dvec3 direction = glm::normalize(glm::dvec3{ray.x, ray.y, -1});
    const double along = -distance * direction.z;
    const double t = along - std::sqrt(std::max(0.0, along * along - (distance * distance - 1)));
    const glm::dvec3 normal = direction * t + glm::dvec3{0, 0, distance};
    return {normal, -direction.z * t, -glm::dot(normal, direction)};
}

struct Sums {
    double inside = 0, covered = 0, facing = 0, angle = 0, depth = 0, outside = 0, spilled = 0;
};

Sums compare(const PointScreen& s, double silhouettePx, double spacingPx) {
    Sums sums;
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            const double r = std::hypot(x + 0.5 - s.width / 2.0, y + 0.5 - s.height / 2.0);
            const std::size_t i = s.at(x, y);
            const bool shown = !std::isinf(s.depth[i]);
            if (r > silhouettePx + spacingPx) {
                ++sums.outside;
                sums.spilled += shown ? 1 : 0;
            }
            if (r > silhouettePx - 2) continue;
            ++sums.inside;
            sums.covered += shown ? 1 : 0;
            const Hit hit = hitAt(s, x, y);
            if (!shown || hit.facing < 0.3) continue;
            ++sums.facing;
            sums.angle += std::acos(std::clamp(glm::dot(hit.normal, normalOf(s.normals[i])), -1.0, 1.0));
            sums.depth += std::abs(double(s.depth[i]) - hit.depth);
        }
    }
    return sums;
}

TEST_P(PyramidSurface, CoversASphereAndKnowsItsNormals) {
    for (const SurfaceSetting& setting : surfaceSettings(slow_)) {
        SpherePicture p = sphere(setting);
        passes_->run(p.screen, p.spacing);
        const Sums sums = compare(p.screen, p.silhouettePx, setting.spacingPx);
        EXPECT_GE(sums.covered / sums.inside, 0.999) << nameOf(setting);
        EXPECT_LE(sums.angle / sums.facing * degrees, 3) << nameOf(setting);
        EXPECT_GT(sums.facing, 0.7 * sums.inside) << nameOf(setting);
        EXPECT_LE(sums.depth / sums.facing, 0.5 * p.spacing) << nameOf(setting);
        EXPECT_LE(sums.spilled / sums.outside, 0.05) << nameOf(setting);
        for (std::size_t i = 0; i < p.screen.rgba.size(); ++i) {
            const bool shown = !std::isinf(p.screen.depth[i]);
            ASSERT_EQ(p.screen.rgba[i], shown ? 0xff8040c0 : PointScreen::background);
        }
    }
}

TEST_P(PyramidSurface, LevelsSmoothTheNoiseOfNormals) {
    // Bouchiba, Deschaud and Goulette, "Raw point cloud deferred shading through screen space pyramidal
    // operators", 2018, §3.3, Fig. 5: a facing sheet with noise; its normal is known, so the angle to it is
    // all noise.
    for (const double spacingPx : {2.0, 3.5}) {
        double error[2] = {};
        for (int turn = 0; turn < 2; ++turn) {
            PointScreen s(640, 480, true, 420);
            const double spacing = spacingPx * 10 / 420;
            Numbers numbers(84);
            sheet(10, 9, 7, spacing, 0.3 * spacing, numbers, [&](const ScreenPoint& p) { s.add(p, 0); });
            passes_->run(s, spacing);
            DepthNormalsPass pass;
            pass.spacing = static_cast<float>(spacing);
            pass.detail = 0;
            pass.scale = turn == 0 ? 2.0f : 0.01f;
            passes_->findNormals(s, pass);
            for (const std::uint32_t code : s.normals) error[turn] += std::acos(normalOf(code).z) * degrees;
            error[turn] /= double(s.normals.size());
        }
        EXPECT_LT(error[0], 0.5 * error[1]) << spacingPx << " px";
        EXPECT_GT(error[1], 5) << "without smoothing there is noise";
    }
}

/// What the method asks for, of a cloud whose noise was measured.
template <class Wanted>
Wanted passOf(double spacing, double noise) {
    const Method& method = *findMethod("pyramid");
    const ParameterValues values = resolveParameters(method, {}).value();
    CloudTraits cloud;
    cloud.spacing = spacing;
    cloud.noise = noise;
    for (const Pass& pass : method.passes(
             {.method = method, .values = values, .shading = Shading::Phong, .cloud = cloud, .detail = 0}))
        if (const auto* wanted = std::get_if<Wanted>(&pass)) return *wanted;
    return {};
}

TEST_P(PyramidSurface, NormalsOfNoisyScansAreAsGoodAsTheNoiseIsKnown) {
    // A facing sheet again: normal noise, so large that two spacings are not enough to see a slope.
    for (const double sigma : {0.1, 0.3, 0.45, 1.0}) {
        PointScreen s(480, 360, true, 420);
        const double spacing = 3.0 * 10 / 420;
        Numbers numbers(84);
        sheet(10, 9, 7, spacing, 0, numbers, [&](ScreenPoint p) {
            double height = -6;
            for (int k = 0; k < 12; ++k) height += numbers.uniform();
            p.x += numbers.uniform(-0.3, 0.3) * spacing;
            p.y += numbers.uniform(-0.3, 0.3) * spacing;
            p.depth += height * sigma * spacing;
            s.add(p, 0);
        });
        passes_->hidePoints(s, passOf<HiddenPointsPass>(spacing, sigma * spacing));
        passes_->fill(s, {});
        passes_->findNormals(s, passOf<DepthNormalsPass>(spacing, sigma * spacing));
        double error = 0;
        for (const std::uint32_t code : s.normals)
            error += std::acos(std::min(1.0, normalOf(code).z)) * degrees;
        EXPECT_LE(error / double(s.normals.size()), 3.0) << sigma << " spacings";
    }
}

TEST_P(PyramidSurface, ReliefStaysThatIsAsFineAsTheNoise) {
    // A sheet with waves of eight spacings, as wide as a statue's lips: their slopes are known. Measured, a scan with
    // such relief has a noise of a quarter of its spacing.
    PointScreen s(480, 360, true, 420);
    const double spacing = 3.0 * 10 / 420, wave = 8 * spacing, steepest = std::tan(25 / degrees);
    const double turns = 2 * std::numbers::pi / wave;
    Numbers numbers(84);
    sheet(10, 9, 7, spacing, 0, numbers, [&](ScreenPoint p) {
        p.depth += steepest / turns * std::sin(turns * p.x);
        s.add(p, 0);
    });
    passes_->hidePoints(s, passOf<HiddenPointsPass>(spacing, 0.25 * spacing));
    passes_->fill(s, {});
    passes_->findNormals(s, passOf<DepthNormalsPass>(spacing, 0.25 * spacing));
    double slope = 0, error = 0;
    for (std::size_t i = 0; i < s.normals.size(); ++i) {
        const double x = (double(i % 480) + 0.5 - 240) * 10 / 420;
        const glm::dvec3 truth = glm::normalize(glm::dvec3(steepest * std::cos(turns * x), 0, 1));
        slope += std::acos(truth.z) * degrees;
        error += std::acos(std::clamp(glm::dot(truth, normalOf(s.normals[i])), -1.0, 1.0)) * degrees;
    }
    EXPECT_LE(error, 0.6 * slope);
}

}  // namespace
}  // namespace scancast::test
