#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

using glm::dvec3;

constexpr double ground = pavementHeight;

const Material* plain(Model& model, int color, float reflectance = 0.5F, float variation = 0.05F) {
    return model.add<PlainMaterial>(
        PlainMaterial::Options{.color = rgb(color), .reflectance = reflectance, .variation = variation});
}

/// The board that tells where you are. It faces south; detail scans put more points on it.
void addSign(Model& model, dvec3 center) {
    constexpr double width = 6.4, height = 2.5, thick = 0.12, foot = 1.15, detail = 14;
    SignMaterial::Options sign;
    sign.board = rgb(0x14324f);
    sign.rim = rgb(0xf2c14e);
    sign.rimWidth = 0.07;
    sign.lines = {{"SCANCAST", 0.72, 1.5, rgb(0xffffff), 1.3},
                  {"POINT CLOUDS - LIVE", 0.28, 0.98, rgb(0xf2c14e), 1.15},
                  {"TOWN SQUARE - 21 SCANS", 0.17, 0.6, rgb(0xd7e6f2), 1.1},
                  {"DRAG TO TURN / WHEEL TO ZOOM", 0.14, 0.28, rgb(0xa9c4d8), 1.1}};
    const dvec3 low = center + dvec3(-width / 2, 0, foot);
    model.add(Patch::trapezoid(low, {width, 0, 0}, {0, 0, height}), model.add<SignMaterial>(sign), detail);
    const Material* back = plain(model, 0x7d858c);
    model.add(Patch::trapezoid(low + dvec3(width, thick, 0), {-width, 0, 0}, {0, 0, height}), back);
    model.add(Patch::trapezoid(low + dvec3(0, 0, height), {width, 0, 0}, {0, thick, 0}), back, 3);
    model.add(Patch::trapezoid(low + dvec3(width, 0, 0), {0, thick, 0}, {0, 0, height}), back, 3);
    model.add(Patch::trapezoid(low + dvec3(0, thick, 0), {0, -thick, 0}, {0, 0, height}), back, 3);
    for (const double side : {-0.38, 0.38})
        model.add(Patch::tube(center + dvec3(width * side, 0.2, 0), {0, 0, foot + height}, 0.07, 0.07), back,
                  2);
    model.occluders.push_back(Occluder::box(low + dvec3(0, 0.01, 0), low + dvec3(width, thick, height)));
}

void addFountain(Model& model, dvec3 at) {
    const Material* stone = plain(model, 0xcfc6b2, 0.55F, 0.12F);
    const Material* water = model.add<PlainMaterial>(PlainMaterial::Options{.color = rgb(0x5b8f9c),
                                                                            .reflectance = 0.1F,
                                                                            .classification = 9,
                                                                            .variation = 0.3F,
                                                                            .variationSize = 0.25F});
    constexpr double radius = 3.2, rim = 0.4, high = 0.62;
    model.add(Patch::tube(at, {0, 0, high}, radius, radius), stone);
    model.add(Patch::disc(at + dvec3(0, 0, high), radius - rim, radius + 0.06), stone, 1.5);
    model.add(Patch::disc(at + dvec3(0, 0, high - 0.14), 0, radius - rim), water);
    model.add(Patch::disc(at + dvec3(0, 0, 0.06), radius, radius + 0.7), stone);
    model.add(Patch::tube(at, {0, 0, 2.0}, 0.4, 0.24), stone, 2);
    model.add(Patch::tube(at + dvec3(0, 0, 1.75), {0, 0, 0.4}, 0.35, 1.15), stone, 2);
    model.add(Patch::disc(at + dvec3(0, 0, 2.1), 0, 1.12), water, 2);
    model.add(Patch::tube(at + dvec3(0, 0, 2.1), {0, 0, 0.9}, 0.2, 0.12), stone, 2);
    model.add(Patch::ball(at + dvec3(0, 0, 3.15), 0.27), stone, 3);
    Occluder basin = Occluder::box(at - dvec3(2.2, 2.2, 0), at + dvec3(2.2, 2.2, high - 0.2));
    model.occluders.push_back(basin);
    model.occluders.push_back(Occluder::box(at + dvec3(-0.75, -0.75, 1.85), at + dvec3(0.75, 0.75, 2.0)));
    model.occluders.push_back(Occluder::box(at + dvec3(-0.2, -0.2, 0), at + dvec3(0.2, 0.2, 3.2)));
}

void addLamp(Model& model, dvec3 foot, const Material* iron, const Material* glass) {
    model.add(Patch::tube(foot, {0, 0, 0.9}, 0.13, 0.08), iron, 2);
    model.add(Patch::tube(foot + dvec3(0, 0, 0.9), {0, 0, 3.1}, 0.06, 0.05), iron, 2);
    model.add(Patch::tube(foot + dvec3(0, 0, 4.0), {0, 0, 0.5}, 0.14, 0.24), glass, 3);
    model.add(Patch::tube(foot + dvec3(0, 0, 4.5), {0, 0, 0.28}, 0.3, 0.02), iron, 3);
    model.occluders.push_back(Occluder::box(foot - dvec3(0.06, 0.06, 0), foot + dvec3(0.06, 0.06, 4.0)));
    model.occluders.push_back(Occluder::box(foot + dvec3(-0.2, -0.2, 4.0), foot + dvec3(0.2, 0.2, 4.6)));
}

void addBench(Model& model, dvec3 at, double angle, const Material* wood, const Material* iron) {
    const dvec3 x(std::cos(angle), std::sin(angle), 0), y(-x.y, x.x, 0);
    for (int slat = 0; slat < 3; ++slat) {
        model.addBox(at + y * (0.17 * slat - 0.17) + dvec3(0, 0, 0.45), {1.8, 0.13, 0.04}, wood, angle, 2,
                     true);
        if (slat < 2)
            model.addBox(at + y * 0.27 + dvec3(0, 0, 0.62 + 0.18 * slat), {1.8, 0.04, 0.12}, wood, angle, 2);
    }
    for (const double side : {-0.7, 0.7})
        model.addBox(at + x * side + dvec3(0, 0, 0.3), {0.06, 0.5, 0.6}, iron, angle, 2);
}

void addStall(Model& model, dvec3 at, double angle, int stripe, const Material* wood, std::uint32_t salt) {
    const dvec3 x(std::cos(angle), std::sin(angle), 0), y(-x.y, x.x, 0), z(0, 0, 1);
    const Material* cloth = model.add<StripedMaterial>(StripedMaterial::Options{
        .first = rgb(0xf4efe4), .second = rgb(stripe), .width = 0.3, .reflectance = 0.7F});
    constexpr double w = 3.2, d = 2.2;
    const dvec3 front = at - x * (w / 2) - y * (d / 2) + z * 2.1,
                back = at + x * (w / 2) + y * (d / 2) + z * 2.1;
    model.add(Patch::trapezoid(front, x * w, y * (d / 2) + z * 0.6), cloth, 1.5);
    model.add(Patch::trapezoid(back, -x * w, -y * (d / 2) + z * 0.6), cloth, 1.5);
    model.add(Patch::trapezoid(front - z * 0.3, x * w, z * 0.3), cloth, 2);
    model.add(Patch::trapezoid(back - z * 0.3, -x * w, z * 0.3), cloth, 2);
    for (const double i : {-0.48, 0.48})
        for (const double j : {-0.46, 0.46})
            model.add(Patch::tube(at + x * (w * i) + y * (d * j), z * 2.1, 0.04, 0.04), wood, 2);
    model.addBox(at + z * 0.42, {w - 0.3, 1.1, 0.84}, wood, angle, 1);
    static constexpr std::array goods{0xd9482b, 0xe7a62c, 0x6f9e3a, 0x8c2f57, 0xf0d24f, 0xc96f2d};
    for (int i = 0; i < 6; ++i) {
        const Material* fruit = plain(model, goods[(i + salt) % goods.size()], 0.5F, 0.35F);
        model.addBox(at + x * (0.46 * i - 1.15) - y * 0.1 + z * 0.92, {0.4, 0.8, 0.16}, fruit, angle, 3);
    }
    // Shade under the cloth and on the ground; the ends are open, so a slab will do.
    const dvec3 reach = glm::abs(x * (w / 2)) + glm::abs(y * (d / 2));
    model.occluders.push_back(Occluder::box(at - reach + z * 2.2, at + reach + z * 2.35));
    model.occluders.push_back(Occluder::box(at - reach * 0.5, at + reach * 0.5 + z * 0.8));
}

/// The outline of a car from the side: x along it, and the height there.
struct Outline {
    double x, z;
};
constexpr std::array<Outline, 8> bodyLine{{{0, 0.55},
                                           {0.12, 0.78},
                                           {1.05, 0.95},
                                           {1.75, 1.42},
                                           {3.05, 1.45},
                                           {3.75, 1.02},
                                           {4.15, 0.95},
                                           {4.22, 0.6}}};

void addCar(Model& model, dvec3 at, double angle, int color) {
    const dvec3 x(std::cos(angle), std::sin(angle), 0), y(-x.y, x.x, 0), z(0, 0, 1);
    const Material* paint = plain(model, color, 0.45F, 0.03F);
    const Material* glass = plain(model, 0x27323a, 0.1F);
    const Material* rubber = plain(model, 0x1e1e1f, 0.15F);
    const Material* metal = plain(model, 0xaeb2b5, 0.6F);
    constexpr double half = 0.86, belt = 0.93, sill = 0.28, roofHalf = 0.68;
    const dvec3 rear = at - x * 2.1;
    for (std::size_t i = 0; i + 1 < bodyLine.size(); ++i) {
        const Outline a = bodyLine[i], b = bodyLine[i + 1];
        const bool window = i == 2 || i == 4;
        const auto width = [&](double height) { return height > 1.2 ? roofHalf : half; };
        const dvec3 from = rear + x * a.x + z * a.z + y * width(a.z),
                    to = rear + x * b.x + z * b.z + y * width(b.z);
        model.add(Patch::trapezoid(from, -y * (2 * width(a.z)), to - from, width(b.z) / width(a.z)),
                  window ? glass : paint, 1.3);
    }
    for (const double side : {-1.0, 1.0}) {
        const dvec3 out = y * (side * half);
        const auto panel = [&](dvec3 from, dvec3 u, dvec3 v, double taper, const Material* material) {
            // Mirrored for the far side, so that both face outwards.
            if (side > 0) {
                from += u;
                v += u * (taper - 1);
                u = -u;
            }
            model.add(Patch::trapezoid(from, u, v, taper), material, 1.3);
        };
        panel(rear + out + z * sill, x * 4.22, z * (belt - sill), 1, paint);
        const dvec3 lean = y * (side * (roofHalf - half));
        panel(rear + out + x * 1.05 + z * belt, x * 2.75, x * 0.7 + z * 0.5 + lean, 0.47, glass);
        panel(rear + out + x * 2.42 + z * belt + y * (side * 0.01), x * 0.09, z * 0.5 + lean, 1, paint);
        for (const double wheel : {0.78, 3.42}) {
            const dvec3 hub = rear + x * wheel + y * (side * (half - 0.16)) + z * 0.31;
            model.add(Patch::tube(hub, y * (side * 0.18), 0.31, 0.31), rubber, 1.5);
            model.add(Patch::tube(hub + y * (side * 0.18), y * (side * 0.012), 0.31, 0.17), rubber, 3);
            model.add(Patch::tube(hub + y * (side * 0.19), y * (side * 0.01), 0.17, 0.01), metal, 3);
        }
    }
    const Material* lamp = plain(model, 0xf6f2dc, 0.9F);
    const Material* tail = plain(model, 0xb3201f, 0.7F);
    for (const double side : {-0.62, 0.62}) {
        model.addBox(rear + x * 0.02 + y * side + z * 0.68, {0.1, 0.34, 0.14}, lamp, angle, 3);
        model.addBox(rear + x * 4.2 + y * side + z * 0.76, {0.08, 0.3, 0.16}, tail, angle, 3);
    }
    model.addBox(rear + x * 2.11 + z * 0.42, {4.3, 1.7, 0.26}, paint, angle, 0.8);
    const dvec3 reach = glm::abs(x * 2.0) + glm::abs(y * 0.82);
    model.occluders.push_back(Occluder::box(at - reach + z * 0.25, at + reach + z * 0.9));
    const dvec3 cabin = glm::abs(x * 1.1) + glm::abs(y * 0.66);
    model.occluders.push_back(
        Occluder::box(at + x * 0.25 - cabin + z * 0.9, at + x * 0.25 + cabin + z * 1.4));
}

}  // namespace

void addStreetFurniture(Model& model) {
    addSign(model, {0, -8.6, ground});
    addFountain(model, {0, 0, ground});
    const Material* iron = plain(model, 0x2d3a36, 0.3F);
    const Material* glass = plain(model, 0xf7ecc4, 0.6F);
    const Material* wood = plain(model, 0x8a5f38, 0.45F, 0.2F);
    for (int row = 0; row < townBlocks; ++row)
        for (int column = 0; column < townBlocks; ++column) {
            const TownBlock block = townBlock(column, row);
            for (const double along : {0.22, 0.78}) {
                const double x = block.x0 + (block.x1 - block.x0) * along,
                             y = block.y0 + (block.y1 - block.y0) * along;
                if (row < 4 && std::abs(x) < 98) addLamp(model, {x, block.y1 - 0.7, ground}, iron, glass);
                if (column < 4 && std::abs(y) < 98) addLamp(model, {block.x1 - 0.7, y, ground}, iron, glass);
            }
        }
    for (int i = 0; i < 6; ++i) {
        const double turn = 6.2831853 * (i + 0.5) / 6;
        addBench(model, {6.6 * std::cos(turn), 6.6 * std::sin(turn), ground}, turn - 1.5707963, wood, iron);
    }
    addStall(model, {-11, -4.5, ground}, 1.5707963, 0xb5382c, wood, 0);
    addStall(model, {-11, 1.0, ground}, 1.5707963, 0x2f6d4f, wood, 1);
    addStall(model, {-11, 6.5, ground}, 1.5707963, 0x2b5c8a, wood, 2);
    addStall(model, {11, -4.5, ground}, -1.5707963, 0xd08a1d, wood, 3);
    addStall(model, {11, 1.0, ground}, -1.5707963, 0x7a3b69, wood, 4);
    addStall(model, {11, 6.5, ground}, -1.5707963, 0xb5382c, wood, 5);
    static constexpr std::array paints{0x9c1f26, 0x24466b, 0xd9d7d0, 0x33373a,
                                       0xc8a02e, 0x55705c, 0x8b8f94, 0x3d6f8e};
    int car = 0;
    for (const double street : {-69.75, -25.25, 25.25, 69.75})
        for (double y = -92; y < 95; y += 11.5) {
            const double fromCrossing = std::min(std::min(std::abs(y + 63.75), std::abs(y + 21.25)),
                                                 std::min(std::abs(y - 21.25), std::abs(y - 63.75)));
            const float chance = hashUnit(int(street), int(y), 61);
            if (fromCrossing < 11 || chance > 0.62F) continue;
            const double side = chance < 0.31F ? -1 : 1;
            addCar(model, {street + side * 2.25, y, 0.02}, side > 0 ? -1.5707963 : 1.5707963,
                   paints[std::size_t(car++) % paints.size()]);
        }
    for (const double street : {-63.75, -21.25, 21.25, 63.75})
        for (double x = -92; x < 95; x += 12.5) {
            const double fromCrossing = std::min(std::min(std::abs(x + 69.75), std::abs(x + 25.25)),
                                                 std::min(std::abs(x - 25.25), std::abs(x - 69.75)));
            const float chance = hashUnit(int(x), int(street), 62);
            if (fromCrossing < 11 || chance > 0.5F) continue;
            const double side = chance < 0.25F ? -1 : 1;
            addCar(model, {x, street + side * 2.25, 0.02}, side > 0 ? 0 : 3.1415927,
                   paints[std::size_t(car++) % paints.size()]);
        }
}

}  // namespace scancast
