// The two scenes whose surface is a formula: a unit sphere and a flat test chart.
#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"

namespace scancast {
namespace {

/// Each octant has its own hue, lines every 15 degrees tell how it is turned; north is lighter than south.
class GlobeMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const glm::vec3 n = point.normal;
        point.color = glm::vec3(0.5F) + 0.38F * n;
        const float azimuth = std::atan2(n.y, n.x) * 57.29578F,
                    height = std::asin(std::clamp(n.z, -1.0F, 1.0F)) * 57.29578F;
        const auto toLine = [](float degrees) { return std::abs(degrees - 15 * std::round(degrees / 15)); };
        const float lines = std::min(toLine(azimuth) * std::cos(height / 57.29578F), toLine(height));
        if (lines < 0.7F) point.color = point.color * 0.35F;
        if (std::abs(height) < 1.4F) point.color = glm::vec3(0.95F);
        if (std::abs(azimuth) < 1.4F && n.x > 0) point.color = glm::vec3(0.85F, 0.1F, 0.1F);
        point.reflectance = 0.4F + 0.4F * float(lines < 0.7F);
        point.classification = n.z > 0 ? 1 : 2;
    }
};

/// Checkers with a colour sweep, a ruler along the edges and a white panel with text.
class ChartMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const double x = point.position.x, y = point.position.y;
        const bool dark = ((int(std::floor(x * 4)) + int(std::floor(y * 4))) & 1) != 0;
        const glm::vec3 sweep(0.57F + 0.33F * float(x), 0.55F - 0.2F * float(y), 0.6F + 0.3F * float(y));
        point.color = dark ? sweep * 0.35F : blend(sweep, glm::vec3(1), 0.45F);
        point.reflectance = dark ? 0.25F : 0.75F;
        point.classification = dark ? 1 : 2;
        const double edge = std::min(1 - std::abs(x), 1 - std::abs(y));
        if (edge < 0.04) {
            const double along = 1 - std::abs(x) < 1 - std::abs(y) ? y : x;
            point.color = glm::vec3((int(std::floor(along * 20)) & 1) ? 0.05F : 0.95F);
        }
    }
};

}  // namespace

Model makeSphere() {
    Model model;
    model.smallestCell = 0.04;
    model.largestCell = 0.5;
    model.add(Patch::ball({0, 0, 0}, 1), model.add<GlobeMaterial>());
    for (const glm::dvec3 at :
         {glm::dvec3(5, 0, 0), {-5, 0, 0}, {0, 5, 0}, {0, -5, 0}, {0, 0, 5}, {0, 0, -5}})
        model.stations.push_back(at);
    return model;
}

Model makePlane() {
    Model model;
    model.smallestCell = 0.04;
    model.largestCell = 0.5;
    const Material* chart = model.add<ChartMaterial>();
    SignMaterial::Options sign;
    sign.board = glm::vec3(0.96F);
    sign.rim = rgb(0x1d3557);
    sign.rimWidth = 0.015;
    sign.lines = {{"SCANCAST", 0.14, 0.215, rgb(0x1d3557)},
                  {"POINTS BY THE BILLION", 0.05, 0.115, rgb(0xc1121f)},
                  {"ABCDEFGHIJKLM 0123456789", 0.03, 0.045, rgb(0x222222)}};
    // The panel lies in the plane, so the chart is laid around it.
    const double w = 0.625, h = 0.2;
    const auto strip = [&](double x0, double y0, double x1, double y1, const Material* material) {
        model.add(Patch::trapezoid({x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}), material);
    };
    strip(-w, -h, w, h, model.add<SignMaterial>(sign));
    strip(-1, -1, 1, -h, chart);
    strip(-1, h, 1, 1, chart);
    strip(-1, -h, -w, h, chart);
    strip(w, -h, 1, h, chart);
    model.stations = {{0, -0.4, 4}};
    return model;
}

}  // namespace scancast
