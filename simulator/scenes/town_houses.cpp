#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

constexpr double setback = 2.5, houseDepth = 9.5, overhang = 0.45, roofDensity = 0.55;

/// Clay tiles in rows down the slope.
class RoofMaterial final : public Material {
  public:
    RoofMaterial(glm::vec3 color, std::uint32_t salt) : color_(color), salt_(salt) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        constexpr double tileWidth = 0.26, tileLength = 0.34;
        const int row = int(std::floor(point.t / tileLength));
        const double across = point.s / tileWidth + 0.5 * (row & 1), down = point.t / tileLength - row;
        const int column = int(std::floor(across));
        const float own = hashUnit(column, row, salt_), round = float(std::sin((across - column) * 3.14159));
        const float moss = smoothNoise({float(point.s) * 0.5F, float(point.t) * 0.5F}, salt_ + 1);
        point.color = color_ * (0.78F + 0.2F * own + 0.14F * round) * (down > 0.86 ? 0.72F : 1.0F);
        if (moss > 0.68F) point.color = blend(point.color, rgb(0x6f7350), 0.5F * (moss - 0.68F) / 0.32F);
        point.color *= 0.97F + 0.06F * point.random->unit();
        point.raise(0.03 * round + 0.02 * (1 - down));
        point.reflectance = 0.35F;
        point.classification = buildingClass;
        if (patch.lengthV - point.t < 0.12) point.color = color_ * 0.7F;  // ridge
    }
    double relief() const override { return 0.05; }

  private:
    glm::vec3 color_;
    std::uint32_t salt_;
};

/// Boarded soffits, reveals and other small pieces.
const Material* plain(Model& model, glm::vec3 color, float reflectance = 0.5F) {
    return model.add<PlainMaterial>(PlainMaterial::Options{
        .color = color, .reflectance = reflectance, .classification = buildingClass, .variation = 0.05F});
}

/// The four narrow sides of every window and door opening.
void addReveals(Model& model, const FacadeMaterial& facade, const HouseStyle& style, glm::dvec3 corner,
                glm::dvec3 along, glm::dvec3 outwards, const Material* material, double density) {
    const glm::dvec3 up(0, 0, 1);
    for (int storey = 0; storey < style.storeys; ++storey) {
        for (int column = 0; column < style.columns; ++column) {
            const auto hole = facade.opening(column, storey);
            if (!hole) continue;
            const glm::dvec3 in = -outwards * hole->depth;
            const auto at = [&](double x, double y) { return corner + along * x + up * y; };
            const glm::dvec3 across = along * (hole->x1 - hole->x0), high = up * (hole->y1 - hole->y0);
            const auto side = [&](glm::dvec3 from, glm::dvec3 u, glm::dvec3 v) {
                model.add(Patch::trapezoid(from, u, v), material, density).lightOffset = outwards * 0.25;
            };
            side(at(hole->x0, hole->y0), in, high);
            side(at(hole->x1, hole->y0) + in, -in, high);
            side(at(hole->x0, hole->y0), across, in);
            side(at(hole->x0, hole->y1), in, across);
        }
    }
}

void addWall(Model& model, const HouseStyle& style, glm::dvec3 corner, glm::dvec3 along, double width,
             bool front, double density, int columns) {
    HouseStyle own = style;
    own.columns = columns;
    const glm::dvec3 outwards = glm::cross(along, glm::dvec3(0, 0, 1));
    const Material* material =
        model.add<FacadeMaterial>(own, width, front, glm::vec3(along), glm::vec3(outwards));
    Patch& wall =
        model.add(Patch::trapezoid(corner, along * width, {0, 0, style.height()}), material, density);
    wall.lightOffset = outwards * 0.25;
    wall.hideInside = true;
    if (density > 0.9)
        addReveals(model, static_cast<const FacadeMaterial&>(*material), own, corner, along, outwards,
                   plain(model, style.trim * 0.92F), density);
}

void addRoof(Model& model, const HouseStyle& style, glm::dvec3 corner, glm::dvec3 along, glm::dvec3 back,
             double width, double depth, double rise) {
    const double top = style.height(), slope = rise / (depth / 2);
    const glm::dvec3 up(0, 0, 1);
    const Material* tiles = model.add<RoofMaterial>(style.roof, style.salt);
    const Material* wood = plain(model, style.trim * 0.85F);
    const glm::dvec3 eave = corner + up * (top - overhang * slope) - back * overhang;
    const glm::dvec3 run = back * (depth / 2 + overhang) + up * (rise + overhang * slope);
    const glm::dvec3 farEave =
        corner + up * (top - overhang * slope) + back * (depth + overhang) + along * width;
    const glm::dvec3 farRun = -back * (depth / 2 + overhang) + up * (rise + overhang * slope);
    model.add(Patch::trapezoid(eave, along * width, run), tiles, roofDensity + 0.15);
    model.add(Patch::trapezoid(farEave, -along * width, farRun), tiles, roofDensity - 0.15);
    // Fascia and gutter: what one sees of the roof from the street.
    model.add(Patch::trapezoid(eave - up * 0.16, along * width, up * 0.17), wood);
    model
        .add(Patch::trapezoid(eave - up * 0.16 + back * overhang, along * width, -back * overhang), wood, 0.6)
        .lightOffset = -back * (overhang + 0.1) - up * 0.1;
    // Gables, where a lower neighbour leaves them free.
    const Material* gable = model.add<PlainMaterial>(PlainMaterial::Options{.color = style.wall,
                                                                            .reflectance = 0.55F,
                                                                            .classification = buildingClass,
                                                                            .variation = 0.07F,
                                                                            .variationSize = 1.5F,
                                                                            .salt = style.salt});
    const glm::dvec3 base = corner + up * top;
    model
        .add(Patch::trapezoid(base + back * depth, -back * depth,
                              back * (depth / 2) + up * rise - back * depth, 0),
             gable, 0.9)
        .hideInside = true;
    Patch& farGable = model.add(
        Patch::trapezoid(base + along * width, back * depth, back * (depth / 2) + up * rise, 0), gable, 0.9);
    farGable.hideInside = true;
}

void addChimney(Model& model, const HouseStyle& style, glm::dvec3 at, double angle) {
    const Material* brick = plain(model, glm::vec3(0.52F, 0.32F, 0.26F));
    model.addBox(at, {0.7, 0.55, 1.7}, brick, angle);
    model.addBox(at + glm::dvec3(0, 0, 0.9), {0.85, 0.7, 0.12}, plain(model, style.trim * 0.8F), angle, 1,
                 true);
    model.add(Patch::tube(at + glm::dvec3(0, 0, 0.95), {0, 0, 0.4}, 0.14, 0.12), plain(model, rgb(0xa8583c)));
}

/// A window in the roof with a little gable of its own.
void addDormer(Model& model, const HouseStyle& style, glm::dvec3 foot, glm::dvec3 along, glm::dvec3 back,
               double slope) {
    constexpr double width = 1.5, height = 1.35;
    const glm::dvec3 up(0, 0, 1), left = foot - along * (width / 2);
    HouseStyle own = style;
    own.storeys = 1;
    own.columns = 1;
    own.shop.clear();
    own.shutters = own.quoins = false;
    own.windowWidth = 0.9;
    own.windowHeight = 0.95;
    own.sillHeight = -0.02;
    own.groundHeight = height - 0.45 + 0.35;
    const glm::dvec3 outwards = -back;
    const Material* front =
        model.add<FacadeMaterial>(own, width, false, glm::vec3(along), glm::vec3(outwards));
    model.add(Patch::trapezoid(left, along * width, up * height), front, 1).lightOffset = outwards * 0.3;
    const double deep = height / slope;
    const Material* cheek = plain(model, style.roof * 0.85F);
    model.add(Patch::trapezoid(left, up * height, back * deep + up * height, 0), cheek);
    model.add(Patch::trapezoid(left + along * width + up * height, -up * height, back * deep, 0), cheek);
    const Material* tiles = model.add<RoofMaterial>(style.roof, style.salt + 5);
    const glm::dvec3 ridge = foot + up * (height + 0.55), lip = -back * 0.2;
    const double ridgeDeep = (height + 0.55) / slope;
    const glm::dvec3 leftEave = left - along * 0.15 + up * (height - 0.1) + lip;
    const glm::dvec3 rightEave = left + along * (width + 0.15) + up * (height - 0.1) + lip;
    model.add(Patch::trapezoid(leftEave + back * ridgeDeep, -back * ridgeDeep, ridge + lip - leftEave), tiles,
              0.8);
    model.add(Patch::trapezoid(rightEave, back * ridgeDeep, ridge + lip - rightEave), tiles, 0.8);
    model.add(Patch::trapezoid(left + up * height, along * width, along * (width / 2) + up * 0.55, 0),
              plain(model, style.wall));
}

HouseStyle styleOf(std::uint32_t salt) {
    static constexpr std::array walls{0xe8d3a2, 0xd9a66b, 0xe6e0d2, 0xc9d2c0, 0xb9c9d6,
                                      0xd98f76, 0xeadfc0, 0xd7b98e, 0xc7b7a3, 0xe5b8a0};
    static constexpr std::array bricks{0x9c5a45, 0xa9694f, 0x8a4f42};
    static constexpr std::array roofs{0xa5533a, 0xb4623f, 0x8f4a38, 0x6b6460, 0x9a5f45};
    static constexpr std::array doors{0x2f5d50, 0x7a2e2a, 0x2b4a6f, 0x6b4226, 0x3a3a3c, 0x8a6a2f};
    static constexpr std::array shutters{0x4d6b4f, 0x5b7c93, 0x7b3f35, 0x3f5a52};
    static const std::array<const char*, 14> shops{"BAKERY",   "BOOKS",  "CAFE",     "HOTEL",     "FLOWERS",
                                                   "PHARMACY", "TAILOR", "OPTICIAN", "TEA HOUSE", "RECORDS",
                                                   "BICYCLES", "POST",   "BARBER",   "MAPS"};
    const auto pick = [&](std::uint32_t what, const auto& from) {
        return from[std::size_t(mixBits(salt, what) % from.size())];
    };
    const auto chance = [&](std::uint32_t what) { return unitFloat(mixBits(salt, what)); };
    HouseStyle style;
    style.salt = salt;
    style.brick = chance(1) < 0.24F;
    style.wall = style.brick ? rgb(pick(2, bricks)) : rgb(pick(2, walls));
    style.trim = style.brick ? rgb(0xe4dccb) : blend(rgb(0xf2ece0), style.wall, 0.15F);
    style.roof = rgb(pick(3, roofs));
    style.door = rgb(pick(4, doors));
    style.shutter = rgb(pick(5, shutters));
    style.frame = chance(6) < 0.8F ? rgb(0xf4f2ec) : rgb(0x59493c);
    style.storeys = 2 + int(chance(7) * 2.2F);
    style.storeyHeight = 2.9 + 0.3 * chance(8);
    style.groundHeight = 3.45;
    style.windowHeight = 1.5 + 0.25 * chance(9);
    style.windowWidth = 1.0 + 0.25 * chance(10);
    style.shutters = !style.brick && chance(11) < 0.35F;
    style.quoins = chance(12) < 0.35F;
    if (chance(13) < 0.42F) style.shop = pick(14, shops);
    return style;
}

/// Houses side by side from `from` to `to`, their fronts to the right of the way.
void addRow(Model& model, glm::dvec3 from, glm::dvec3 to, std::uint32_t salt, double backDensity) {
    const double length = glm::distance(from, to);
    const int count = std::max(1, int(std::round(length / 8.3)));
    const glm::dvec3 along = (to - from) / length;
    double at = 0;
    for (int i = 0; i < count; ++i) {
        const double left = length - at, share = left / (count - i);
        const double width = i + 1 == count ? left : share * (0.88 + 0.24 * hashUnit(i, int(salt), 31));
        addHouse(model, styleOf(salt * 64 + std::uint32_t(i)), from + along * at, along, width, houseDepth,
                 backDensity);
        at += width;
    }
}

}  // namespace

void addHouse(Model& model, const HouseStyle& given, glm::dvec3 corner, glm::dvec3 along, double width,
              double depth, double backDensity) {
    HouseStyle style = given;
    style.columns = std::max(2, int(width / 2.4));
    const glm::dvec3 up(0, 0, 1), back = -glm::cross(along, up);
    const double top = style.height(), rise = depth * (0.36 + 0.1 * hashUnit(int(style.salt), 3, 32)),
                 slope = rise / (depth / 2);
    Occluder body;
    const glm::dvec3 farCorner = corner + along * width + back * depth;
    body.addPlane(-back, corner);
    body.addPlane(back, farCorner);
    body.addPlane(-along, corner);
    body.addPlane(along, farCorner);
    body.addPlane(glm::normalize(up * (depth / 2) - back * rise), corner + up * top);
    body.addPlane(glm::normalize(up * (depth / 2) + back * rise), farCorner + up * top);
    body.center = (corner + farCorner) * 0.5 + up * (top + rise) * 0.5;
    body.radius = float(glm::length(glm::dvec3(width, depth, top + rise)) / 2);
    body.solid = true;
    model.occluders.push_back(body);

    addWall(model, style, corner, along, width, true, 1, style.columns);
    HouseStyle plainBack = style;
    plainBack.shop.clear();
    addWall(model, plainBack, farCorner, -along, width, false, backDensity, style.columns);
    addWall(model, plainBack, corner + back * depth, -back, depth, false, 0.95, 3);
    addWall(model, plainBack, corner + along * width, back, depth, false, 0.95, 3);
    addRoof(model, style, corner, along, back, width, depth, rise);
    const double angle = std::atan2(along.y, along.x), place = hashUnit(int(style.salt), 4, 33);
    addChimney(model, style,
               corner + along * (width * (0.2 + 0.6 * place)) + back * (depth * 0.62) +
                   up * (top + rise * 0.76 + 0.6),
               angle);
    if (hashUnit(int(style.salt), 5, 34) < 0.55F) {
        const int dormers = width > 8 ? 2 : 1;
        for (int i = 0; i < dormers; ++i)
            addDormer(
                model, style,
                corner + along * (width * (i + 1) / (dormers + 1)) + back * 1.1 + up * (top + 1.1 * slope),
                along, back, slope);
    }
}

void addHouses(Model& model) {
    for (int row = 0; row < townBlocks; ++row) {
        for (int column = 0; column < townBlocks; ++column) {
            if (column == 2 && (row == 2 || row == 3)) continue;
            const TownBlock block = townBlock(column, row);
            const double z = pavementHeight, limit = 98;
            const double x0 = std::max(block.x0 + setback, -limit), x1 = std::min(block.x1 - setback, limit);
            const double y0 = std::max(block.y0 + setback, -limit), y1 = std::min(block.y1 - setback, limit);
            const auto salt = std::uint32_t(row * 5 + column) * 4;
            const bool nearSquare = std::abs(column - 2) <= 1 && std::abs(row - 2) <= 1;
            const double backs = nearSquare ? 0.5 : 0.4;
            // South and north rows run through; west and east ones fill what is left between them.
            const bool south = row > 0, north = row < townBlocks - 1;
            if (south) addRow(model, {x0, y0, z}, {x1, y0, z}, salt, backs);
            if (north) addRow(model, {x1, y1, z}, {x0, y1, z}, salt + 1, backs);
            const double low = south ? y0 + houseDepth : y0, high = north ? y1 - houseDepth : y1;
            if (column > 0 && high - low > 6) addRow(model, {x0, high, z}, {x0, low, z}, salt + 2, backs);
            if (column < townBlocks - 1 && high - low > 6)
                addRow(model, {x1, low, z}, {x1, high, z}, salt + 3, backs);
        }
    }
}

}  // namespace scancast
