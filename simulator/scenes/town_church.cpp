#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

/// Ashlar with tall round-headed windows.
class ChurchWall final : public Material {
  public:
    ChurchWall(double width, int windows, double foot, double top, glm::vec3 along, glm::vec3 outwards)
        : width_(width),
          foot_(foot),
          top_(top),
          windows_(windows),
          sunAlong_(glm::dot(townSun, along)),
          sunOut_(glm::dot(townSun, outwards)) {}

    void apply(const Patch& patch, SurfacePoint& point) const override {
        point.classification = buildingClass;
        point.reflectance = 0.55F;
        constexpr double course = 0.42, block = 0.9;
        const int row = int(std::floor(point.t / course));
        const double across = point.s / block + 0.5 * (row & 1);
        const int column = int(std::floor(across));
        const float own = hashUnit(column, row, 51),
                    cloud = smoothNoise({float(point.s) * 0.4F, float(point.t) * 0.3F}, 52);
        float tone = 0.9F + 0.16F * own + 0.1F * (cloud - 0.5F) + 0.04F * (point.random->unit() - 0.5F);
        const double joint = std::min(std::min(across - column, column + 1 - across) * block,
                                      std::min(point.t / course - row, row + 1 - point.t / course) * course);
        if (joint < 0.015) tone *= 0.8F;
        point.color = blend(rgb(0xc9b48c), rgb(0xb5a58b), own) * tone;
        const double corner = std::min(point.s, width_ - point.s);
        if (corner < 0.6 || point.t < 0.7 || patch.lengthV - point.t < 0.5) point.raise(0.08);
        if (windows_ > 0) window(point);
    }
    double relief() const override { return 0.3; }

  private:
    void window(SurfacePoint& point) const {
        constexpr double half = 0.62;
        const double pitch = width_ / windows_, x = point.s - (std::floor(point.s / pitch) + 0.5) * pitch;
        const double arch = top_ - half;
        const auto reach = [&](double dx, double y) {
            return y > arch ? std::hypot(dx, y - arch) - half : std::max(std::abs(dx) - half, foot_ - y);
        };
        const double outside = reach(x, point.t);
        if (outside > 0.22) return;
        point.reflectance = 0.2F;
        if (outside > 0) {
            point.color = rgb(0xdccba6) * (0.95F + 0.06F * point.random->unit());
            point.raise(0.05);
            return;
        }
        constexpr double depth = 0.3;
        point.raise(-depth);
        // Leaded panes of coloured glass.
        const int column = int(std::floor(x / 0.2)), row = int(std::floor(point.t / 0.28));
        const double u = x / 0.2 - column, v = point.t / 0.28 - row;
        static constexpr std::array glass{0x27456e, 0x7c2634, 0x9a7a2a, 0x2f6350, 0x3c5d86};
        point.color =
            rgb(glass[std::size_t(mixBits(std::uint64_t(row * 64 + column + 4096)) % glass.size())]);
        if (std::min(u, v) < 0.14 || std::abs(x) < 0.05) point.color = glm::vec3(0.13F);
        point.openness = float(0.55 + 0.45 * std::min(1.0, -outside / 0.4));
        if (sunOut_ > 0.02 &&
            reach(x + depth / sunOut_ * sunAlong_, point.t + depth / sunOut_ * townSun.z) > 0)
            point.sunlit = 0;
    }

    double width_, foot_, top_;
    int windows_;
    double sunAlong_, sunOut_;
};

class ClockMaterial final : public Material {
  public:
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const double x = point.s - patch.lengthU / 2, y = point.t - patch.lengthV / 2, r = std::hypot(x, y),
                     radius = patch.lengthU / 2;
        const double hour = std::atan2(x, y) / 6.283185307 * 12,
                     off = std::abs(hour - std::round(hour)) * r * 6.283185307 / 12;
        const auto hand = [&](double turn, double length) {
            const double along = x * std::sin(turn) + y * std::cos(turn),
                         across = x * std::cos(turn) - y * std::sin(turn);
            return along > -0.1 && along < length * radius && std::abs(across) < 0.055;
        };
        point.classification = buildingClass;
        point.color = rgb(0xf3efe2);
        point.reflectance = 0.7F;
        const bool ink =
            (r > 0.72 * radius && r < 0.9 * radius && off < 0.06) || hand(5.27, 0.5) || hand(0.34, 0.78);
        if (r > 0.93 * radius && r < radius) point.color = rgb(0xc9a23f);
        if (ink) point.color = rgb(0x1c2733);
        if (r > radius) point.color = rgb(0xb5a58b);
    }
};

class SlateMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const int row = int(std::floor(point.t / 0.28));
        const int column = int(std::floor(point.s / 0.34 + 0.5 * (row & 1)));
        point.color = blend(rgb(0x4c5a5e), rgb(0x6f8a80), hashUnit(column, row, 53)) *
                      (0.94F + 0.1F * point.random->unit());
        if (point.t / 0.28 - row > 0.86) point.color *= 0.75F;
        point.reflectance = 0.3F;
        point.classification = buildingClass;
    }
};

/// Four walls around a rectangle, south, east, north, west.
void addWalls(Model& model, glm::dvec3 low, glm::dvec3 size, std::array<int, 4> windows, double foot,
              double top) {
    const glm::dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    const std::array<glm::dvec3, 4> corners{low, low + x, low + x + y, low + y}, ways{x, y, -x, -y};
    for (std::size_t i = 0; i < 4; ++i) {
        const double width = glm::length(ways[i]);
        const glm::dvec3 along = ways[i] / width, outwards = glm::cross(along, glm::dvec3(0, 0, 1));
        Patch& wall = model.add(
            Patch::trapezoid(corners[i], ways[i], z),
            model.add<ChurchWall>(width, windows[i], foot, top, glm::vec3(along), glm::vec3(outwards)), 0.9);
        wall.lightOffset = outwards * 0.3;
        wall.hideInside = true;
    }
}

}  // namespace

void addChurch(Model& model, glm::dvec3 center) {
    const Material* slate = model.add<SlateMaterial>();
    const glm::dvec3 up(0, 0, 1);
    // The nave, its ridge from south to north.
    constexpr double width = 11, length = 20, wall = 8.5, rise = 6;
    const glm::dvec3 low = center - glm::dvec3(width / 2, length / 2, 0);
    addWalls(model, low, {width, length, wall}, {2, 5, 2, 5}, 2.2, 6.8);
    const double ratio = rise / (width / 2);
    const glm::dvec3 eave(0.4, 0, 0.4 * ratio);
    const glm::dvec3 west = low + up * wall - eave,
                     east = low + glm::dvec3(width, 0, wall) + glm::dvec3(0.4, 0, -0.4 * ratio);
    model.add(Patch::trapezoid(west + glm::dvec3(0, length, 0), {0, -length, 0},
                               glm::dvec3(width / 2, 0, rise) + eave),
              slate, 0.7);
    model.add(Patch::trapezoid(east, {0, length, 0}, glm::dvec3(-width / 2 - 0.4, 0, rise + 0.4 * ratio)),
              slate, 0.7);
    const Material* gable =
        model.add<ChurchWall>(width, 0, 0.0, 0.0, glm::vec3(1, 0, 0), glm::vec3(0, -1, 0));
    model.add(Patch::trapezoid(low + up * wall, {width, 0, 0}, {width / 2, 0, rise}, 0), gable).hideInside =
        true;
    model.add(
        Patch::trapezoid(low + glm::dvec3(width, length, wall), {-width, 0, 0}, {-width / 2, 0, rise}, 0),
        gable);
    Occluder nave = Occluder::box(low, low + glm::dvec3(width, length, wall + rise));
    nave.planeCount = 4;  // keep the four walls; the box's top and bottom give way to the roof
    nave.addPlane(glm::normalize(glm::vec3(-rise, 0, width / 2)), low + up * wall);
    nave.addPlane(glm::normalize(glm::vec3(rise, 0, width / 2)), low + glm::dvec3(width, 0, wall));
    nave.solid = true;
    model.occluders.push_back(nave);
    // The tower in front of it.
    constexpr double side = 6.4, height = 21, spire = 11;
    const glm::dvec3 foot = center + glm::dvec3(-side / 2, -length / 2 - side + 0.6, 0);
    addWalls(model, foot, {side, side, height}, {1, 1, 1, 1}, 11.2, 14.6);
    model.occluders.push_back(Occluder::box(foot, foot + glm::dvec3(side, side, height)));
    model.occluders.back().solid = true;
    const glm::dvec3 rim = foot + glm::dvec3(-0.35, -0.35, height),
                     apex = foot + glm::dvec3(side / 2, side / 2, height + spire);
    const double w = side + 0.7;
    const std::array<glm::dvec3, 4> corners{rim, rim + glm::dvec3(w, 0, 0), rim + glm::dvec3(w, w, 0),
                                            rim + glm::dvec3(0, w, 0)};
    for (std::size_t i = 0; i < 4; ++i)
        model.add(Patch::trapezoid(corners[i], corners[(i + 1) % 4] - corners[i], apex - corners[i], 0),
                  slate);
    Occluder top;
    for (std::size_t i = 0; i < 4; ++i)
        top.addPlane(glm::normalize(glm::cross(corners[(i + 1) % 4] - corners[i], apex - corners[i])), apex);
    top.addPlane(-up, rim);
    top.center = (rim + apex) * 0.5;
    top.radius = float(spire * 0.5 + w);
    model.occluders.push_back(top);
    const Material* clock = model.add<ClockMaterial>();
    constexpr double face = 2.6;
    const double z = 16.2, m = (side - face) / 2, off = 0.12;
    model.add(Patch::trapezoid(foot + glm::dvec3(m, -off, z), {face, 0, 0}, {0, 0, face}), clock, 3);
    model.add(Patch::trapezoid(foot + glm::dvec3(side + off, m, z), {0, face, 0}, {0, 0, face}), clock, 3);
    model.add(Patch::trapezoid(foot + glm::dvec3(-off, side - m, z), {0, -face, 0}, {0, 0, face}), clock, 3);
    const Material* gold = model.add<PlainMaterial>(
        PlainMaterial::Options{.color = rgb(0xd9b24c), .reflectance = 0.8F, .classification = buildingClass});
    model.add(Patch::tube(apex - up * 0.3, up * 2.0, 0.06, 0.05), gold, 3);
    model.add(Patch::ball(apex + up * 0.3, 0.22), gold, 3);
    // The portal.
    const Material* oak =
        model.add<StripedMaterial>(StripedMaterial::Options{.first = rgb(0x5d3b22),
                                                            .second = rgb(0x6c4629),
                                                            .width = 0.22,
                                                            .reflectance = 0.4F,
                                                            .classification = buildingClass});
    model
        .add(Patch::trapezoid(foot + glm::dvec3(side / 2 - 1.1, -0.1, 0.1), {2.2, 0, 0}, {0, 0, 3.1}), oak,
             1.5)
        .lightOffset = {0, -0.3, 0};
    model.addBox(foot + glm::dvec3(side / 2, -0.7, 0.08), {3.4, 1.4, 0.16}, gable);
}

}  // namespace scancast
