// A living room, 6 m x 5 m, with a marked mirror on its north wall. The scanner sees the room in the mirror
// as if it went on behind the wall, and records it there: those points are exact reflections, through the
// glass's rectangle.
#include <cmath>

#include "simulator/materials.hpp"

namespace scancast {
namespace {

using glm::dvec3;

constexpr double width = 6, depth = 5, height = 2.7;
constexpr double wallX0 = -width / 2, wallX1 = width / 2, wallY0 = -depth / 2, wallY1 = depth / 2;
constexpr double mirrorX = 0.3, mirrorZ = 1.45, mirrorWidth = 1.8, mirrorHeight = 1.3;
constexpr double windowY0 = -1.0, windowY1 = 1.0, windowZ0 = 0.9, windowZ1 = 2.2;
constexpr std::uint8_t floorClass = 2, wallClass = 6;

class TileMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        constexpr double tile = 0.4;
        const int column = int(std::floor(point.s / tile)), row = int(std::floor(point.t / tile));
        const double u = point.s / tile - column, v = point.t / tile - row;
        const float own = hashUnit(column, row, 71);
        const bool dark = ((column + row) & 1) != 0;
        const float vein = smoothNoise({float(point.s) * 7 + own * 40, float(point.t) * 3}, 72);
        point.color = (dark ? rgb(0x6f5b4b) : rgb(0xd8cbb4)) * (0.92F + 0.08F * own + 0.08F * (vein - 0.5F));
        if (std::min(std::min(u, 1 - u), std::min(v, 1 - v)) < 0.012) point.color = rgb(0x8d857a);
        point.reflectance = dark ? 0.35F : 0.6F;
        point.classification = floorClass;
    }
};

/// Painted above, panelled below, a rail between.
class WallMaterial final : public Material {
  public:
    explicit WallMaterial(glm::vec3 color) : color_(color) {}
    void apply(const Patch&, SurfacePoint& point) const override {
        const double z = point.position.z, run = point.position.x + point.position.y;
        const float roll = smoothNoise({float(run) * 4, float(z) * 4}, 73);
        point.color = color_ * (0.97F + 0.04F * roll);
        if (z < 0.9) {
            const double u = run / 0.6 - std::floor(run / 0.6),
                         rim = std::min(std::min(u, 1 - u) * 0.6, std::min(z - 0.15, 0.84 - z));
            point.color = rgb(0xf1ece1) * (rim > 0.05 && rim < 0.065 ? 0.8F : 1.0F);
            if (z > 0.86 || z < 0.1) point.color = rgb(0xfaf6ec);
        }
        point.color *= 0.985F + 0.03F * point.random->unit();
        point.openness = float(0.75 + 0.25 * std::min(1.0, std::min(z, height - z) / 0.5));
        point.reflectance = 0.7F;
        point.classification = wallClass;
    }

  private:
    glm::vec3 color_;
};

class RugMaterial final : public Material {
  public:
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const double x = std::abs(point.s / patch.lengthU - 0.5) * 2,
                     y = std::abs(point.t / patch.lengthV - 0.5) * 2;
        const double edge = std::max(x, y), diamond = std::abs(x * 4 - std::floor(x * 4) - 0.5) +
                                                      std::abs(y * 3 - std::floor(y * 3) - 0.5);
        point.color = edge > 0.93      ? rgb(0xe8dcc0)
                      : edge > 0.8     ? rgb(0x27394f)
                      : diamond < 0.3  ? rgb(0xe3b658)
                      : diamond < 0.45 ? rgb(0x27394f)
                                       : rgb(0x9b2f2f);
        point.color *= 0.85F + 0.25F * point.random->unit();
        point.reflectance = 0.4F;
        point.classification = floorClass;
    }
};

class WoodMaterial final : public Material {
  public:
    explicit WoodMaterial(glm::vec3 color, std::uint32_t salt) : color_(color), salt_(salt) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const bool lengthwise = patch.lengthU > patch.lengthV;
        const auto along = float(lengthwise ? point.s : point.t),
                   across = float(lengthwise ? point.t : point.s);
        const float ring = smoothNoise({along * 1.6F, across * 34}, salt_);
        point.color = color_ * (0.82F + 0.32F * ring) * (0.98F + 0.04F * point.random->unit());
        point.reflectance = 0.5F;
    }

  private:
    glm::vec3 color_;
    std::uint32_t salt_;
};

/// A picture on the wall: hills under an evening sky.
class PaintingMaterial final : public Material {
  public:
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const auto u = float(point.s / patch.lengthU), v = float(point.t / patch.lengthV);
        point.color = blend(rgb(0xf6c177), rgb(0x6f8fc0), std::clamp((v - 0.35F) * 1.7F, 0.0F, 1.0F));
        if (std::hypot((u - 0.68F) * 1.5F, v - 0.62F) < 0.09F) point.color = rgb(0xfff0c0);
        if (v < 0.5F + 0.1F * std::sin(u * 6)) point.color = rgb(0x5f7f8f);
        if (v < 0.36F + 0.08F * std::sin(u * 9 + 1)) point.color = rgb(0x466b4f);
        if (v < 0.2F + 0.07F * std::sin(u * 5 + 2)) point.color = rgb(0x2f4a35);
        point.reflectance = 0.5F;
    }
};

class OutdoorMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const auto v = float((point.position.z - windowZ0) / (windowZ1 - windowZ0));
        point.color = blend(rgb(0xdcebf5), rgb(0x9cc4ea), v);
        if (v < 0.3F + 0.1F * smoothNoise({float(point.s) * 5, 0}, 74)) point.color = rgb(0x86a86a);
        point.color *= 1.15F;
        point.openness = 1.6F;
        point.reflectance = 0.15F;
        point.classification = wallClass;
    }
};

struct RoomBuilder {
    Model& model;

    const Material* plain(int color, float reflectance = 0.5F, float variation = 0.03F) {
        return model.add<PlainMaterial>(
            PlainMaterial::Options{.color = rgb(color), .reflectance = reflectance, .variation = variation});
    }
    void box(dvec3 center, dvec3 size, const Material* material, double angle = 0, bool shadow = true) {
        model.addBox(center, size, material, angle, 1, center.z - size.z / 2 > 0.01);
        if (shadow && angle == 0)
            model.occluders.push_back(Occluder::box(center - size * 0.5, center + size * 0.5));
    }
    /// A wall from left to right as one sees it from inside, with a rectangle left out.
    void wallWithHole(dvec3 corner, dvec3 along, double length, double x0, double x1, double z0, double z1,
                      const Material* material) {
        const auto piece = [&](double u0, double v0, double u1, double v1) {
            model.add(Patch::trapezoid(corner + along * u0 + dvec3(0, 0, v0), along * (u1 - u0),
                                       dvec3(0, 0, v1 - v0)),
                      material);
        };
        piece(0, 0, length, z0);
        piece(0, z1, length, height);
        piece(0, z0, x0, z1);
        piece(x1, z0, length, z1);
    }
    void shell();
    void window();
    void mirror();
    void table();
    void chair(dvec3 at, double turn, const Material* wood, const Material* cushion);
    void shelf();
    void lampAndPlant();
};

void RoomBuilder::shell() {
    model.add(Patch::trapezoid({wallX0, wallY0, 0}, {width, 0, 0}, {0, depth, 0}), model.add<TileMaterial>());
    model.add(Patch::trapezoid({wallX0, wallY1, height}, {width, 0, 0}, {0, -depth, 0}),
              plain(0xf4f1ea, 0.8F), 0.8);
    const Material* sage = model.add<WallMaterial>(rgb(0xb9c8b0));
    const Material* cream = model.add<WallMaterial>(rgb(0xe6d8b8));
    wallWithHole({wallX0, wallY1, 0}, {1, 0, 0}, width, mirrorX - mirrorWidth / 2 - wallX0,
                 mirrorX + mirrorWidth / 2 - wallX0, mirrorZ - mirrorHeight / 2, mirrorZ + mirrorHeight / 2,
                 sage);
    wallWithHole({wallX1, wallY1, 0}, {0, -1, 0}, depth, wallY1 - windowY1, wallY1 - windowY0, windowZ0,
                 windowZ1, cream);
    model.add(Patch::trapezoid({wallX1, wallY0, 0}, {-width, 0, 0}, {0, 0, height}), cream);
    model.add(Patch::trapezoid({wallX0, wallY0, 0}, {0, depth, 0}, {0, 0, height}), sage);
    model.add(Patch::trapezoid({-1.3, -1.0, 0.008}, {2.8, 0, 0}, {0, 2.0, 0}), model.add<RugMaterial>(), 1.5);
    const dvec3 corner(1.0, wallY0 + 0.03, 1.25);
    model.add(Patch::trapezoid(corner + dvec3(1.2, 0, 0), {-1.2, 0, 0}, {0, 0, 0.8}),
              model.add<PaintingMaterial>(), 3);
    const Material* frame = model.add<WoodMaterial>(rgb(0x6b4a2b), 81);
    for (const double z : {1.22, 2.08}) box({1.6, wallY0 + 0.03, z}, {1.32, 0.06, 0.06}, frame, 0, false);
    for (const double x : {0.97, 2.23}) box({x, wallY0 + 0.03, 1.65}, {0.06, 0.06, 0.92}, frame, 0, false);
}

void RoomBuilder::window() {
    const double recess = 0.2;
    const Material* white = plain(0xf7f5ef, 0.8F);
    const dvec3 out(recess, 0, 0), y(0, windowY1 - windowY0, 0), z(0, 0, windowZ1 - windowZ0);
    const dvec3 low(wallX1, windowY0, windowZ0);
    model.add(Patch::trapezoid(low + y + out, -y, z), model.add<OutdoorMaterial>(), 1);
    model.add(Patch::trapezoid(low, out, y), white);
    model.add(Patch::trapezoid(low + z, y, out), white);
    model.add(Patch::trapezoid(low, z, out), white);
    model.add(Patch::trapezoid(low + y, out, z), white);
    for (const double at : {windowY0 + 0.03, 0.0, windowY1 - 0.03})
        box({wallX1 + recess - 0.03, at, (windowZ0 + windowZ1) / 2}, {0.05, 0.06, windowZ1 - windowZ0}, white,
            0, false);
    for (const double at : {windowZ0 + 0.03, 1.75, windowZ1 - 0.03})
        box({wallX1 + recess - 0.03, 0, at}, {0.05, windowY1 - windowY0, 0.06}, white, 0, false);
    box({wallX1 - 0.06, 0, windowZ0 - 0.02}, {0.24, 2.2, 0.04}, white, 0, false);
}

void RoomBuilder::mirror() {
    Mirror mirror;
    mirror.center = {mirrorX, wallY1, mirrorZ};
    mirror.normal = {0, -1, 0};
    mirror.up = {0, 0, 1};
    mirror.width = mirrorWidth;
    mirror.height = mirrorHeight;
    mirror.tint = {236, 243, 240};
    model.mirrors.push_back(mirror);
    const Material* gold = model.add<WoodMaterial>(rgb(0xb98d3e), 82);
    constexpr double bar = 0.08;
    for (const double side : {-1.0, 1.0}) {
        box({mirrorX, wallY1 - 0.02, mirrorZ + side * (mirrorHeight + bar) / 2},
            {mirrorWidth + 2 * bar, 0.04, bar}, gold, 0, false);
        box({mirrorX + side * (mirrorWidth + bar) / 2, wallY1 - 0.02, mirrorZ}, {bar, 0.04, mirrorHeight},
            gold, 0, false);
    }
    // Targets at the corners mark it, so that it can be found in the scan.
    const Material* black = plain(0x101010, 0.05F);
    const Material* white = plain(0xffffff, 0.95F);
    constexpr double cell = 0.035;
    for (const double sx : {-1.0, 1.0})
        for (const double sz : {-1.0, 1.0})
            for (int i = 0; i < 4; ++i) {
                const dvec3 at(mirrorX + sx * (mirrorWidth + bar) / 2 + (i % 2 - 1) * cell, wallY1 - 0.042,
                               mirrorZ + sz * (mirrorHeight + bar) / 2 + (i / 2 - 1) * cell);
                model.add(Patch::trapezoid(at, {cell, 0, 0}, {0, 0, cell}),
                          (i == 0 || i == 3) ? black : white, 3);
            }
}

void RoomBuilder::chair(dvec3 at, double turn, const Material* wood, const Material* cushion) {
    const dvec3 x(std::cos(turn), std::sin(turn), 0), y(-x.y, x.x, 0), z(0, 0, 1);
    box(at + z * 0.44, {0.44, 0.44, 0.05}, cushion, turn, false);
    for (const double i : {-0.19, 0.19}) {
        box(at + x * i - y * 0.19 + z * 0.21, {0.04, 0.04, 0.42}, wood, turn, false);
        box(at + x * i + y * 0.2 + z * 0.46, {0.04, 0.04, 0.92}, wood, turn, false);
    }
    for (const double h : {0.6, 0.74, 0.88})
        box(at + y * 0.2 + z * h, {0.36, 0.025, 0.07}, wood, turn, false);
    const dvec3 reach = (glm::abs(x) + glm::abs(y)) * 0.2;
    model.occluders.push_back(Occluder::box(at - reach + z * 0.40, at + reach + z * 0.46));
}

void RoomBuilder::table() {
    const Material* oak = model.add<WoodMaterial>(rgb(0xa87844), 83);
    const Material* walnut = model.add<WoodMaterial>(rgb(0x6e4a2e), 84);
    const Material* cushion = plain(0x2f6f74, 0.4F, 0.1F);
    box({0.1, 0, 0.735}, {1.7, 0.9, 0.04}, oak);
    for (const double x : {-0.68, 0.88})
        for (const double y : {-0.38, 0.38}) box({x, y, 0.357}, {0.07, 0.07, 0.714}, oak);
    chair({-0.35, -0.75, 0}, 3.14159265, walnut, cushion);
    chair({0.55, -0.75, 0}, 3.24, walnut, cushion);
    chair({-0.35, 0.75, 0}, 0.1, walnut, cushion);
    chair({0.55, 0.78, 0}, -0.08, walnut, cushion);
    const Material* glaze = plain(0x2d5fa3, 0.5F);
    model.add(Patch::tube({0.35, 0.05, 0.755}, {0, 0, 0.12}, 0.06, 0.11), glaze, 4);
    model.add(Patch::tube({0.35, 0.05, 0.875}, {0, 0, 0.14}, 0.11, 0.045), glaze, 4);
    const Material* petals = plain(0xe0527a, 0.6F, 0.25F);
    const Material* stalk = plain(0x3f7a3a, 0.5F, 0.2F);
    for (int i = 0; i < 7; ++i) {
        const double turn = 2.39996 * i, out = 0.05 + 0.018 * i;
        const dvec3 from(0.35, 0.05, 1.0), way(out * std::cos(turn), out * std::sin(turn), 0.28 - 0.015 * i);
        model.add(Patch::tube(from, way, 0.005, 0.004), stalk, 4);
        model.add(Patch::ball(from + way, 0.04), petals, 4);
    }
    const Material* fruit = plain(0xd8622b, 0.6F, 0.1F);
    model.add(Patch::disc({-0.3, -0.05, 0.76}, 0, 0.18), plain(0xf4f0e6, 0.7F), 3);
    for (const dvec3 at :
         {dvec3(-0.35, -0.08, 0.805), {-0.26, -0.09, 0.805}, {-0.3, 0.0, 0.805}, {-0.3, -0.06, 0.87}})
        model.add(Patch::ball(at, 0.045), fruit, 4);
}

void RoomBuilder::shelf() {
    const Material* pine = model.add<WoodMaterial>(rgb(0xc9a06a), 85);
    constexpr double deep = 0.32, y0 = -1.9, y1 = 0.5, top = 2.1, x = wallX0 + deep / 2;
    for (const double y : {y0, (y0 + y1) / 2, y1})
        box({x, y, top / 2}, {deep, 0.03, top}, pine, 0, y != (y0 + y1) / 2);
    static constexpr std::array covers{0xb23a3a, 0x2e5e8c, 0xe0b040, 0x3f7d58, 0x6a3f7a,
                                       0xd97b3a, 0xe9e2cf, 0x27303f, 0x8c9fae, 0xa34e6d};
    for (int board = 0; board < 6; ++board) {
        const double z = 0.06 + board * 0.408;
        box({x, (y0 + y1) / 2, z}, {deep, y1 - y0, 0.03}, pine);
        if (board == 5) break;
        double y = y0 + 0.05;
        for (int book = 0; y < y1 - 0.12; ++book) {
            const double thick = 0.022 + 0.035 * hashUnit(book, board, 86),
                         tall = 0.2 + 0.13 * hashUnit(book, board, 87),
                         wide = 0.17 + 0.08 * hashUnit(book, board, 88);
            const bool gap =
                hashUnit(book, board, 89) > 0.9F || std::abs(y + thick / 2 - (y0 + y1) / 2) < 0.05;
            if (!gap)
                box({wallX0 + 0.02 + wide / 2 + 0.04, y + thick / 2, z + 0.016 + tall / 2},
                    {wide, thick, tall},
                    plain(covers[std::size_t(mixBits(std::uint64_t(book), std::uint64_t(board)) %
                                             covers.size())],
                          0.45F, 0.12F),
                    0, false);
            y += thick + (gap ? 0.06 : 0.003);
        }
    }
}

void RoomBuilder::lampAndPlant() {
    const Material* brass = plain(0xb08d45, 0.7F);
    model.add(Patch::tube({0.1, 0, 2.1}, {0, 0, 0.6}, 0.008, 0.008), brass, 3);
    model.add(Patch::tube({0.1, 0, 1.92}, {0, 0, 0.22}, 0.26, 0.09), plain(0xf5e3b5, 0.7F), 2);
    const Material* clay = plain(0xb5603c, 0.5F);
    const dvec3 at(2.45, -1.95, 0);
    model.add(Patch::tube(at, {0, 0, 0.4}, 0.16, 0.23), clay, 2);
    model.add(Patch::disc(at + dvec3(0, 0, 0.38), 0, 0.22), plain(0x3b2a1f), 2);
    const Material* leaf = plain(0x3f7f3c, 0.6F, 0.4F);
    for (int i = 0; i < 22; ++i) {
        const double turn = 2.39996 * i, lift = 0.35 + 0.045 * i, out = 0.5 - 0.012 * i;
        const dvec3 way(std::cos(turn) * out, std::sin(turn) * out, lift),
            side(-std::sin(turn) * 0.06, std::cos(turn) * 0.06, 0);
        model.add(Patch::trapezoid(at + dvec3(0, 0, 0.4) - side, side * 2.0, side + way * 0.8, 0.05), leaf,
                  2);
    }
    model.occluders.push_back(Occluder::box(at + dvec3(-0.18, -0.18, 0), at + dvec3(0.18, 0.18, 0.4)));
}

/// Every patch of the room once more, as it is seen in the mirror.
void addReflections(Model& model) {
    const std::size_t real = model.patches.size();
    for (std::size_t i = 0; i < real; ++i) {
        Patch copy = model.patches[i];
        copy.mirror = 0;
        model.patches.push_back(copy);
    }
}

}  // namespace

Model makeRoom() {
    Model model;
    model.light.kind = Light::Kind::Lamp;
    model.light.towards = {0.1F, 0, 2.0F};
    model.light.color = glm::vec3(0.85F, 0.75F, 0.58F);
    model.light.sky = glm::vec3(0.44F, 0.46F, 0.50F);
    model.light.ground = glm::vec3(0.40F, 0.37F, 0.33F);
    model.light.lampReach = 2.6F;
    model.rangeNoise = 0.001;
    model.smallestCell = 0.06;
    model.largestCell = 0.5;
    RoomBuilder build{model};
    build.shell();
    build.window();
    build.mirror();
    build.table();
    build.shelf();
    build.lampAndPlant();
    model.stations = {{-1.7, -1.6, 1.5}, {1.9, -1.2, 1.5}, {0.3, -2.0, 1.4}};
    addReflections(model);
    return model;
}

}  // namespace scancast
