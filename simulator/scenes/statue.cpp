// A statue in the open, 3.1 m high: a draped figure of pale stone on a plinth with mouldings and an
// inscription, on a round of paving. Curved, smoothly joined, with folds, a face and letters of known size:
// what people who record monuments look at first.
#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/glyphs.hpp"
#include "simulator/scenes/sculpture.hpp"

namespace scancast {
namespace {

using glm::dvec3;

constexpr double plinthTop = 1.2, dieHalf = 0.34, dieFoot = 0.26, dieTop = 1.0;
constexpr std::uint8_t statueClass = 1, plinthClass = 6;

/// Smooth noise in space, 0 … 1: three planes of it.
float noise3(const glm::vec3& at, std::uint32_t salt) {
    return (smoothNoise({at.x + 0.31F * at.z, at.y + 0.17F * at.z}, salt) +
            smoothNoise({at.y + 0.23F * at.x, at.z}, salt + 1) +
            smoothNoise({at.z + 0.41F * at.y, at.x}, salt + 2)) /
           3;
}

/// Weathered marble: clouds, grey veins, specks, and the grey that rain leaves in folds. `sheltered` 0 … 1.
glm::vec3 marble(const glm::vec3& at, float sheltered, float up, PointRandom& random) {
    const float cloud = noise3(at * 2.6F, 121), fine = noise3(at * 19.0F, 131),
                grain = noise3(at * 140.0F, 141);
    const float warp = 2.2F * noise3(at * 3.3F, 151);
    const float vein = std::abs(std::sin(5.5F * (at.x + 0.6F * at.z - 0.4F * at.y) + 3 * warp));
    glm::vec3 color = blend(rgb(0xe9dfcb), rgb(0xcfc2aa), cloud);
    color = blend(color, rgb(0x9d968a), 0.55F * std::max(0.0F, 1 - vein / 0.14F));
    color *= 0.93F + 0.09F * fine + 0.07F * grain;
    color = blend(color, rgb(0x6e675b), std::clamp(0.85F * sheltered * (0.5F + fine), 0.0F, 0.6F));
    // Lichen where the sky can see.
    const float lichen = noise3(at * 9.0F + 7.0F, 161);
    if (up > 0.2F && lichen > 0.7F)
        color = blend(color, rgb(0xa7a05a), std::min(1.0F, (lichen - 0.7F) * 7) * 0.4F);
    return color * (0.985F + 0.03F * random.unit());
}

/// The figure's triangles: normals, sky and sun between their corners.
class FigureMaterial final : public Material {
  public:
    explicit FigureMaterial(const Sculpture& figure) : figure_(figure) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const auto second = float(point.s / patch.lengthU), third = float(point.t / patch.lengthV);
        const std::array weights{1 - second - third, second, third};
        glm::vec3 normal(0);
        float open = 0, sun = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            normal += figure_.mesh.normal[patch.corners[i]] * weights[i];
            open += figure_.openness[patch.corners[i]] * weights[i];
            sun += figure_.sunlit[patch.corners[i]] * weights[i];
        }
        point.normal = glm::normalize(normal);
        point.openness = open;
        point.sunlit = sun;
        point.color = marble(point.position, 1.3F * (1 - open), point.normal.z, *point.random);
        point.reflectance = 0.65F;
        point.classification = statueClass;
    }

  private:
    const Sculpture& figure_;
};

/// The plinth's stone; darker below, where it is splashed. One side may carry letters.
class PlinthMaterial final : public Material {
  public:
    struct Line {
        std::string_view text;
        double height, foot;
    };
    explicit PlinthMaterial(std::vector<Line> lines = {}) : lines_(std::move(lines)) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const auto z = float(point.position.z);
        const float splash = std::clamp(1 - z / 0.4F, 0.0F, 1.0F);
        point.color = marble(point.position * 0.9 + 5.0, 0.35F * splash, point.normal.z, *point.random) *
                      glm::vec3(0.93F, 0.92F, 0.90F);
        point.reflectance = 0.6F;
        point.classification = plinthClass;
        if (lines_.empty()) return;
        const double rim =
            std::min(std::min(point.s, patch.lengthU - point.s), std::min(point.t, patch.lengthV - point.t));
        if (rim > 0.035 && rim < 0.047) point.color *= 0.62F;  // a chiselled frame
        for (const Line& line : lines_) {
            const double left = (patch.lengthU - textWidth(line.text) * line.height) / 2,
                         x = (point.s - left) / line.height, y = (point.t - line.foot) / line.height;
            if (!textInk(line.text, x, y, 1.1)) continue;
            // Cut into the stone: the upper edge in shadow, the rest with old gilding.
            const bool shadow = !textInk(line.text, x, y + 0.035, 1.1);
            point.color = shadow ? rgb(0x4a4034) : rgb(0x8a6a2c);
            point.reflectance = 0.3F;
        }
    }

  private:
    std::vector<Line> lines_;
};

/// Rings of setts around the plinth, and gravel outside.
class ForecourtMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        constexpr double stone = 0.16;
        const double x = point.position.x, y = point.position.y, r = std::hypot(x, y);
        const glm::vec2 at{float(x), float(y)};
        const int ring = int(std::floor(r / stone));
        const double count = std::max(8.0, std::floor(6.2832 * (ring + 0.5))),
                     u = (std::atan2(y, x) / 6.283185307 + 0.5) * count;
        const float own = hashUnit(int(u), ring, 171),
                    pebble = hashUnit(int(std::floor(x * 70)), int(std::floor(y * 70)), 172);
        const double gap = std::min(std::min(u - std::floor(u), std::ceil(u) - u) * 6.2832 * r / count,
                                    std::min(r - ring * stone, (ring + 1) * stone - r));
        point.reflectance = 0.45F;
        point.classification = groundClass;
        if (r < 1.92) {
            point.color =
                blend(rgb(0x8d8478), rgb(0x77736d), own) * (0.86F + 0.2F * smoothNoise(at * 6.0F, 173));
            if (gap < 0.008) point.color = rgb(0x57503f);
        } else if (r < 2.08) {
            point.color = rgb(0xb0a78f) * (0.94F + 0.08F * own);
        } else {
            point.color =
                blend(rgb(0xb39f7a), rgb(0x8f8064), pebble) * (0.9F + 0.15F * smoothNoise(at * 2.0F, 174));
        }
        point.color *= 0.97F + 0.06F * point.random->unit();
        // The foot of the plinth keeps the sky away.
        const double away = std::max(std::abs(x), std::abs(y)) - 0.62;
        point.openness = float(0.6 + 0.4 * std::clamp(away / 0.5, 0.0, 1.0));
    }
};

void addPlinth(Model& model) {
    const Material* stone = model.add<PlinthMaterial>();
    const Material* front = model.add<PlinthMaterial>(
        std::vector<PlinthMaterial::Line>{{"CLIO", 0.13, 0.49},
                                          {"MUSE OF HISTORY", 0.034, 0.38},
                                          {"WHAT WAS BUILT FALLS", 0.0225, 0.28},
                                          {"WHAT WAS MEASURED STAYS", 0.0225, 0.235},
                                          {"MMXXVI", 0.035, 0.115}});
    model.addBox({0, 0, 0.07}, {1.24, 1.24, 0.14}, stone, 0, 1.5);
    model.addBox({0, 0, 0.19}, {0.94, 0.94, 0.10}, stone, 0, 1.5);
    const double side = 2 * dieHalf, high = dieTop - dieFoot;
    const dvec3 low(-dieHalf, -dieHalf, dieFoot), x(side, 0, 0), y(0, side, 0), up(0, 0, high);
    model.add(Patch::trapezoid(low, x, up), front, 3);
    model.add(Patch::trapezoid(low + x, y, up), stone, 2);
    model.add(Patch::trapezoid(low + x + y, -x, up), stone, 2);
    model.add(Patch::trapezoid(low + y, -y, up), stone, 2);
    // Mouldings: slabs that grow towards the cornice, with a round between them.
    model.addBox({0, 0, 0.25}, {0.80, 0.80, 0.03}, stone, 0, 2, true);
    model.addBox({0, 0, 1.015}, {0.73, 0.73, 0.03}, stone, 0, 2, true);
    model.addBox({0, 0, 1.065}, {0.86, 0.86, 0.07}, stone, 0, 2, true);
    model.addBox({0, 0, 1.115}, {0.80, 0.80, 0.03}, stone, 0, 2, true);
    for (const double way : {-1.0, 1.0}) {
        model.add(Patch::tube({-0.39, 0.39 * way, 0.275}, {0.78, 0, 0}, 0.02, 0.02), stone, 2);
        model.add(Patch::tube({0.39 * way, -0.39, 0.275}, {0, 0.78, 0}, 0.02, 0.02), stone, 2);
    }
    // The round base that was carved with the figure.
    model.add(Patch::torus({0, 0, 1.155}, {0, 0, 1}, 0.345, 0.025), stone, 2);
    model.add(Patch::tube({0, 0, 1.13}, {0, 0, plinthTop - 1.13}, 0.345, 0.34), stone, 2);
    model.add(Patch::disc({0, 0, plinthTop}, 0, 0.34), stone, 2);
    model.occluders.push_back(Occluder::box({-0.62, -0.62, 0}, {0.62, 0.62, 0.14}));
    model.occluders.push_back(Occluder::box({-0.335, -0.335, 0.14}, {0.335, 0.335, 1.03}));
    model.occluders.push_back(Occluder::box({-0.43, -0.43, 1.03}, {0.43, 0.43, 1.10}));
}

void addFigure(Model& model) {
    const Sculpture& figure = sculpture();
    const Material* marbleMaterial = model.add<FigureMaterial>(figure);
    const dvec3 foot(0, 0, plinthTop);
    for (const std::array<std::uint32_t, 3>& corners : figure.mesh.triangles) {
        const auto at = [&](std::size_t i) { return foot + dvec3(figure.mesh.position[corners[i]]); };
        const dvec3 u = at(1) - at(0), v = at(2) - at(0);
        if (glm::length(glm::cross(u, v)) < 1e-12) continue;
        Patch& patch = model.add(Patch::trapezoid(at(0), u, v, 0), marbleMaterial, 4);
        patch.corners = corners;
        patch.ownShadows = true;
    }
    // What throws her shadow on the ground: skirt, chest and head, a little slimmer than they are.
    model.occluders.push_back(Occluder::box(foot + dvec3(-0.2, -0.15, 0), foot + dvec3(0.2, 0.15, 1.0)));
    model.occluders.push_back(Occluder::box(foot + dvec3(-0.22, -0.1, 1.0), foot + dvec3(0.22, 0.1, 1.5)));
    model.occluders.push_back(Occluder::box(foot + dvec3(-0.08, -0.08, 1.5), foot + dvec3(0.08, 0.1, 1.86)));
}

}  // namespace

Model makeStatue() {
    Model model;
    model.light.kind = Light::Kind::Sun;
    model.light.towards = statueSun;
    model.light.color = glm::vec3(0.98F, 0.90F, 0.76F);
    model.light.sky = glm::vec3(0.40F, 0.44F, 0.50F);
    model.light.ground = glm::vec3(0.24F, 0.22F, 0.19F);
    model.rangeNoise = 0.0005;
    model.smallestCell = 0.05;
    model.largestCell = 0.4;
    model.add(Patch::disc({0, 0, 0}, 0, 2.6), model.add<ForecourtMaterial>(), 0.5);
    addPlinth(model);
    addFigure(model);
    for (int i = 0; i < 8; ++i) {
        const double turn = 0.7853981633974483 * i + 0.2;
        model.stations.push_back({3.2 * std::cos(turn), 3.2 * std::sin(turn), (i & 1) != 0 ? 3.4 : 1.7});
    }
    return model;
}

}  // namespace scancast
