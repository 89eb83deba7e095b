// A river under a bridge, 120 m x 120 m: pillars and a boat below a deck with openings, railings above it,
// and the banks beyond. From under the deck one sees stone at half a metre and the far bank at fifty: what
// hidden point removal must tell apart without losing either.
#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"

namespace scancast {
namespace {

using glm::dvec3;

constexpr double half = 60, river = 20, bankTop = 28;  ///< metres from the middle of the river
constexpr double deckBottom = 5.2, deckTop = 6.0, deckHalf = 5, landHeight = 5.6;
constexpr double openingHalfX = 2, openingHalfY = 1.2;
constexpr std::array openings{-18.0, -6.0, 6.0, 18.0};
constexpr std::uint8_t bridgeClass = 17, waterClass = 9, boatClass = 1;

class WaterMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const auto x = float(point.position.x), y = float(point.position.y);
        const float ripple = smoothNoise({x * 2.1F, y * 0.7F}, 91),
                    slow = smoothNoise({x * 0.2F, y * 0.12F}, 92);
        point.color = blend(rgb(0x3f5f5c), rgb(0x7f9a92), 0.6F * ripple + 0.4F * slow);
        if (ripple > 0.93F) point.color = rgb(0x9db3aa);
        point.reflectance = 0.08F;
        point.classification = waterClass;
    }
};

class MeadowMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const glm::vec2 at{float(point.position.x), float(point.position.y)};
        const float meadow = smoothNoise(at * 0.15F, 93), tuft = smoothNoise(at * 2.3F, 94);
        point.color = blend(rgb(0x6b8a3c), rgb(0xa5a659), meadow) * (0.75F + 0.35F * tuft);
        const double shore = std::abs(point.position.x) - river;
        if (shore < 1.2) point.color = blend(rgb(0x7d7362), point.color, float(std::max(0.0, shore) / 1.2));
        // A road leads to the deck from both sides.
        if (std::abs(point.position.y) < 3.6 && shore > 7)
            point.color = glm::vec3(0.42F) * (0.9F + 0.15F * tuft);
        point.color *= 0.96F + 0.08F * point.random->unit();
        point.reflectance = 0.6F;
        point.classification = groundClass;
    }
};

/// Squared stones in courses; damp and green towards the water.
class MasonryMaterial final : public Material {
  public:
    explicit MasonryMaterial(std::uint8_t classification) : classification_(classification) {}
    void apply(const Patch&, SurfacePoint& point) const override {
        constexpr double course = 0.4, block = 0.75;
        const int row = int(std::floor(point.t / course));
        const double across = point.s / block + 0.5 * (row & 1);
        const int column = int(std::floor(across));
        const float own = hashUnit(column, row, 95),
                    cloud = smoothNoise({float(point.s) * 0.8F, float(point.t) * 0.5F}, 96);
        float tone = 0.86F + 0.22F * own + 0.12F * (cloud - 0.5F) + 0.05F * (point.random->unit() - 0.5F);
        const double joint = std::min(std::min(across - column, column + 1 - across) * block,
                                      std::min(point.t / course - row, row + 1 - point.t / course) * course);
        if (joint < 0.015) tone *= 0.7F;
        point.color = blend(rgb(0xb9a98a), rgb(0xa09482), own) * tone;
        const auto damp = float(std::clamp(1 - (point.position.z - 0.2) / (0.6 + 0.6 * cloud), 0.0, 1.0));
        point.color = blend(point.color, rgb(0x4d5a3c), 0.7F * damp);
        point.reflectance = 0.5F;
        point.classification = classification_;
    }

  private:
    std::uint8_t classification_;
};

/// Concrete as it came out of the boards, with a stain here and there.
class ConcreteMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const double x = point.position.x, y = point.position.y;
        const int board = int(std::floor(y / 0.25));
        const float own = hashUnit(board, int(std::floor(x / 3 + 0.37 * board)), 97),
                    stain = smoothNoise({float(x) * 0.5F, float(y) * 0.9F}, 98);
        point.color = glm::vec3(0.62F, 0.61F, 0.58F) * (0.88F + 0.16F * own - (stain > 0.7F ? 0.18F : 0.0F));
        if (y / 0.25 - board < 0.06) point.color *= 0.8F;
        point.color *= 0.98F + 0.04F * point.random->unit();
        point.reflectance = 0.5F;
        point.classification = bridgeClass;
    }
};

/// Asphalt with an edge line along the pavements.
class DeckMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const double x = point.position.x, y = std::abs(point.position.y);
        const float fine = smoothNoise({float(x) * 3, float(point.position.y) * 3}, 99);
        point.color =
            glm::vec3(0.36F, 0.36F, 0.37F) * (0.9F + 0.2F * fine) * (0.97F + 0.06F * point.random->unit());
        if (y > 3.9) point.color = glm::vec3(0.64F, 0.62F, 0.57F) * (0.92F + 0.12F * fine);
        if (y > 3.6 && y < 3.72) point.color = glm::vec3(0.92F);
        if (y > 1.35 && y < 1.45) point.color = rgb(0xe2b53a);
        point.reflectance = 0.3F;
        point.classification = bridgeClass;
    }
};

struct BridgeBuilder {
    Model& model;

    const Material* plain(int color, std::uint8_t classification, float variation = 0.05F) {
        return model.add<PlainMaterial>(PlainMaterial::Options{
            .color = rgb(color), .classification = classification, .variation = variation});
    }
    void shadow(dvec3 low, dvec3 high) { model.occluders.push_back(Occluder::box(low, high)); }
    void land();
    void deck();
    void pillars();
    void railings();
    void boat();
    void village();
};

void BridgeBuilder::land() {
    constexpr double tile = 10;
    const Material* water = model.add<WaterMaterial>();
    const Material* meadow = model.add<MeadowMaterial>();
    for (double y = -half; y < half; y += tile) {
        for (double x = -river; x < river; x += tile)
            model.add(Patch::trapezoid({x, y, 0}, {tile, 0, 0}, {0, tile, 0}), water, 0.6);
        for (const double side : {-1.0, 1.0}) {
            const double inner = side < 0 ? -bankTop : river, rise = side * landHeight;
            model.add(Patch::trapezoid({inner, y, side < 0 ? landHeight : 0}, {bankTop - river, 0, rise},
                                       {0, tile, 0}),
                      meadow, 0.8);
            for (double x = bankTop; x < half; x += 8)
                model.add(Patch::trapezoid({side < 0 ? -x - 8 : x, y, landHeight}, {8, 0, 0}, {0, tile, 0}),
                          meadow, 0.5);
        }
    }
}

/// A slab from bank to bank: top and bottom around the openings, their four sides, and the two edges.
void BridgeBuilder::deck() {
    const Material* road = model.add<DeckMaterial>();
    const Material* concrete = model.add<ConcreteMaterial>();
    const double thick = deckTop - deckBottom;
    const auto slab = [&](double x0, double y0, double x1, double y1) {
        model.add(Patch::trapezoid({x0, y0, deckTop}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}), road, 1.2);
        model.add(Patch::trapezoid({x0, y1, deckBottom}, {x1 - x0, 0, 0}, {0, y0 - y1, 0}), concrete, 1.5);
        shadow({x0, y0, deckBottom}, {x1, y1, deckTop});
    };
    slab(-bankTop, -deckHalf, bankTop, -openingHalfY);
    slab(-bankTop, openingHalfY, bankTop, deckHalf);
    double from = -bankTop;
    for (const double x : openings) {
        slab(from, -openingHalfY, x - openingHalfX, openingHalfY);
        from = x + openingHalfX;
        const dvec3 low(x - openingHalfX, -openingHalfY, deckBottom), u(2 * openingHalfX, 0, 0),
            v(0, 2 * openingHalfY, 0), up(0, 0, thick);
        model.add(Patch::trapezoid(low, v, up), concrete, 2);  // faces into the opening, all four
        model.add(Patch::trapezoid(low + u + v, -v, up), concrete, 2);
        model.add(Patch::trapezoid(low + v, u, up), concrete, 2);
        model.add(Patch::trapezoid(low + u, -u, up), concrete, 2);
    }
    slab(from, -openingHalfY, bankTop, openingHalfY);
    const dvec3 length(2 * bankTop, 0, 0), up(0, 0, thick);
    model.add(Patch::trapezoid({-bankTop, -deckHalf, deckBottom}, length, up), concrete, 2);
    model.add(Patch::trapezoid({bankTop, deckHalf, deckBottom}, -length, up), concrete, 2);
}

void BridgeBuilder::pillars() {
    const Material* stone = model.add<MasonryMaterial>(bridgeClass);
    const Material* concrete = model.add<ConcreteMaterial>();
    for (const double x : {-12.0, 0.0, 12.0}) {
        for (const double y : {-3.2, 3.2}) {
            model.add(Patch::tube({x, y, -0.3}, {0, 0, 0.9}, 1.25, 1.2), stone, 2.5);
            model.add(Patch::disc({x, y, 0.6}, 0.75, 1.2), concrete, 2.5);
            model.add(Patch::tube({x, y, 0.6}, {0, 0, 3.9}, 0.8, 0.7), stone, 2.5);
            shadow({x - 0.5, y - 0.5, 0}, {x + 0.5, y + 0.5, 4.4});
        }
        model.addBox({x, 0, 4.85}, {1.5, 9, 0.7}, concrete, 0, 2, true);
        shadow({x - 0.75, -4.5, 4.5}, {x + 0.75, 4.5, 5.2});
    }
}

void BridgeBuilder::railings() {
    const Material* iron = plain(0x2f4f4a, bridgeClass);
    const Material* lamp = plain(0xf3e6b8, bridgeClass);
    for (const double y : {-4.85, 4.85}) {
        for (double x = -27.5; x < 28; x += 1.25)
            model.add(Patch::tube({x, y, deckTop}, {0, 0, 1.1}, 0.03, 0.03), iron, 6);
        for (const double z : {0.35, 0.7, 1.08})
            model.add(Patch::tube({-27.5, y, deckTop + z}, {55, 0, 0}, 0.022, 0.022), iron, 6);
        for (const double x : {-22.0, -11.0, 0.0, 11.0, 22.0}) {
            model.add(Patch::tube({x, y, deckTop}, {0, 0, 4.2}, 0.09, 0.05), iron, 4);
            model.add(Patch::ball({x, y, deckTop + 4.35}, 0.22), lamp, 4);
        }
    }
    for (const double x : openings) {
        for (const double y : {-openingHalfY - 0.06, openingHalfY + 0.06}) {
            model.add(Patch::tube({x - openingHalfX, y, deckTop + 0.8}, {2 * openingHalfX, 0, 0}, 0.03, 0.03),
                      iron, 6);
            for (double i = -openingHalfX; i <= openingHalfX; i += 1)
                model.add(Patch::tube({x + i, y, deckTop}, {0, 0, 0.8}, 0.025, 0.025), iron, 6);
        }
    }
}

/// A barge under the second opening: a flared hull with bow and stern, a cabin and barrels.
void BridgeBuilder::boat() {
    const Material* hull = model.add<StripedMaterial>(StripedMaterial::Options{
        .first = rgb(0x7c2f2a), .second = rgb(0x8a3a33), .width = 0.4F, .classification = boatClass});
    const Material* planks = model.add<StripedMaterial>(StripedMaterial::Options{
        .first = rgb(0xb08a5b), .second = rgb(0x9c7748), .width = 0.18F, .classification = boatClass});
    const dvec3 at(5.2, -0.5, 0);
    constexpr double w = 1.1, flare = 0.25, high = 0.9, l = 3.5, tip = 1.8;
    const auto side = [&](dvec3 a, dvec3 b, dvec3 topA, dvec3 topB) {  // two triangles, front to the outside
        model.add(Patch::trapezoid(at + a, b - a, topB - a, 0), hull, 3);
        model.add(Patch::trapezoid(at + topB, topA - topB, a - topB, 0), hull, 3);
    };
    const dvec3 up(0, 0, high);
    const std::array foot{dvec3(w, -l, 0), dvec3(w, l, 0), dvec3(0, l + tip, 0.1), dvec3(-w, l, 0),
                          dvec3(-w, -l, 0)};
    const std::array rim{dvec3(w + flare, -l - 0.2, high), dvec3(w + flare, l, high),
                         dvec3(0, l + tip + 0.5, high + 0.35), dvec3(-w - flare, l, high),
                         dvec3(-w - flare, -l - 0.2, high)};
    for (std::size_t i = 0; i < foot.size(); ++i) {
        const std::size_t k = (i + 1) % foot.size();
        side(foot[i], foot[k], rim[i], rim[k]);
    }
    const double inside = high - 0.3;
    model.add(Patch::trapezoid(at + dvec3(-w - 0.1, -l, inside), {2 * w + 0.2, 0, 0}, {0, 2 * l, 0}), planks,
              3);
    model.add(Patch::trapezoid(at + dvec3(-w - 0.1, l, inside), {2 * w + 0.2, 0, 0}, {w + 0.1, tip, 0}, 0),
              planks, 3);
    const Material* white = plain(0xf0ece0, boatClass);
    const Material* glass = plain(0x33475a, boatClass);
    model.addBox(at + dvec3(0, -1.6, inside + 0.8), {1.5, 2.2, 1.6}, white, 0, 3);
    model.addBox(at + dvec3(0, -1.6, inside + 1.64), {1.8, 2.5, 0.08}, plain(0x2f5d8a, boatClass), 0, 3,
                 true);
    for (const double y : {-2.2, -1.6, -1.0})
        for (const double x : {-0.76, 0.76})
            model.add(Patch::trapezoid(at + dvec3(x, y + (x > 0 ? -0.2 : 0.2), inside + 0.95),
                                       {0, x > 0 ? 0.4 : -0.4, 0}, {0, 0, 0.45}),
                      glass, 4);
    const Material* barrel = plain(0x6f4a2b, boatClass, 0.15F);
    for (const dvec3 place : {dvec3(-0.6, 1.2, 0), {0.1, 1.5, 0}, {0.6, 0.9, 0}, {-0.2, 2.6, 0}}) {
        model.add(Patch::tube(at + place + dvec3(0, 0, inside), {0, 0, 0.42}, 0.24, 0.3), barrel, 4);
        model.add(Patch::tube(at + place + dvec3(0, 0, inside + 0.42), {0, 0, 0.42}, 0.3, 0.24), barrel, 4);
        model.add(Patch::disc(at + place + dvec3(0, 0, inside + 0.84), 0, 0.24), planks, 4);
    }
    shadow(at + dvec3(-w, -l, 0), at + dvec3(w, l, inside - 0.1));
    shadow(at + dvec3(-0.7, -2.65, inside), at + dvec3(0.7, -0.55, inside + 1.5));
}

/// What stands on the far banks, so that there is something to see at the end of the depth.
void BridgeBuilder::village() {
    const Material* stone = model.add<MasonryMaterial>(buildingClass);
    const Material* slate = plain(0x515a66, buildingClass);
    const Material* clay = plain(0xa9573c, buildingClass, 0.15F);
    const std::array places{dvec3(36, 44, 0),  dvec3(50, 22, 0),   dvec3(-38, 40, 0),
                            dvec3(-50, 14, 0), dvec3(-40, -32, 0), dvec3(44, -36, 0)};
    for (const dvec3& place : places) {
        const bool tower = place.y > 43;
        const dvec3 size = tower ? dvec3(6, 6, 16) : dvec3(9, 7, 5.5), foot = place + dvec3(0, 0, landHeight);
        model.addBox(foot + dvec3(0, 0, size.z / 2), size, stone, 0, 1);
        shadow(foot - dvec3(size.x, size.y, 0) * 0.5, foot + dvec3(size.x / 2, size.y / 2, size.z));
        const dvec3 apex = foot + dvec3(0, 0, size.z + (tower ? 7.0 : 3.5));
        std::array<dvec3, 4> eaves;
        for (std::size_t i = 0; i < 4; ++i)
            eaves[i] = foot + dvec3((i == 1 || i == 2) ? size.x * 0.55 : -size.x * 0.55,
                                    i >= 2 ? size.y * 0.55 : -size.y * 0.55, size.z);
        for (std::size_t i = 0; i < 4; ++i)
            model.add(Patch::trapezoid(eaves[i], eaves[(i + 1) % 4] - eaves[i], apex - eaves[i], 0),
                      tower ? slate : clay);
    }
}

}  // namespace

Model makeBridge() {
    Model model;
    model.light.kind = Light::Kind::Sun;
    model.light.towards = glm::normalize(glm::vec3(0.35F, -0.6F, 0.75F));
    model.light.color = glm::vec3(1.0F, 0.94F, 0.82F);
    model.light.sky = glm::vec3(0.42F, 0.47F, 0.55F);
    model.light.ground = glm::vec3(0.27F, 0.26F, 0.23F);
    BridgeBuilder build{model};
    build.land();
    build.deck();
    build.pillars();
    build.railings();
    build.boat();
    build.village();
    model.stations = {{-16, -9, 2.2}, {6, -12, 1.8}, {17, 9, 2.5},    {-5, 10, 1.8},
                      {5, 5, 1.6},    {-7, 0, 1.6},  {-12, 1, 7.7},   {12, -1, 7.7},
                      {-34, 20, 7.4}, {34, 20, 7.4}, {-34, -20, 7.4}, {34, -20, 7.4}};
    return model;
}

}  // namespace scancast
