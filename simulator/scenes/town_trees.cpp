#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

constexpr std::uint8_t highVegetation = 5;
constexpr double leafDensity = 0.5;

/// Clusters of leaves: a ball whose surface is scattered in depth, with single leaves telling themselves
/// apart by tone.
class LeafMaterial final : public Material {
  public:
    LeafMaterial(glm::vec3 color, glm::vec3 crown, float crownRadius, std::uint32_t salt)
        : color_(color), crown_(crown), crownRadius_(crownRadius), salt_(salt) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const auto angle = float(point.s / patch.radius0), height = float(point.t);
        const float lumps = smoothNoise({angle * 3, height * 4}, salt_), scatter = point.random->unit();
        point.raise(patch.radius0 * (0.3 * (lumps - 0.5) - 0.28 * scatter * scatter));
        const glm::dvec3 leaf = point.position * 9.0;
        const std::uint64_t id = mixBits(std::uint64_t(std::int64_t(std::floor(leaf.x))) * 0x9E3779B1U ^
                                             std::uint64_t(std::int64_t(std::floor(leaf.y))) * 0x85EBCA77U,
                                         std::uint64_t(std::int64_t(std::floor(leaf.z))));
        const float tone = unitFloat(id), hue = unitFloat(mixBits(id));
        const glm::vec3 fromCrown = (glm::vec3(point.position) - crown_) / crownRadius_;
        const float depth = std::clamp(glm::length(fromCrown), 0.0F, 1.1F);
        point.color =
            blend(color_, color_ * glm::vec3(1.25F, 1.12F, 0.7F), hue * 0.8F) * (0.7F + 0.5F * tone);
        point.openness = std::clamp(
            0.25F + 0.5F * depth * depth + 0.3F * fromCrown.z - 0.3F * scatter * scatter, 0.12F, 1.0F);
        point.sunlit = std::clamp(0.2F + 0.9F * depth * depth - 0.5F * scatter * scatter, 0.1F, 1.0F);
        point.normal = glm::normalize(point.normal + 0.9F * fromCrown);
        point.reflectance = 0.5F + 0.3F * tone;
        point.classification = highVegetation;
    }
    /// Clusters are at most half as large as the crown.
    double relief() const override { return 0.22 * double(crownRadius_); }

  private:
    glm::vec3 color_, crown_;
    float crownRadius_;
    std::uint32_t salt_;
};

class BarkMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const float ridge = smoothNoise({float(point.s) * 28, float(point.t) * 3}, 41);
        point.color = blend(rgb(0x4b3d30), rgb(0x8d7c68), ridge) * (0.95F + 0.1F * point.random->unit());
        point.raise(0.02 * ridge);
        point.reflectance = 0.4F;
        point.classification = highVegetation;
    }
    double relief() const override { return 0.02; }
};

void addTree(Model& model, glm::dvec3 foot, double height, double radius, std::uint32_t salt,
             const Material* bark) {
    static constexpr std::array greens{0x5f8a34, 0x4f7a33, 0x74963f, 0x688f45, 0x86983c};
    const auto chance = [&](int what) { return double(hashUnit(int(salt), what, 40)); };
    const double stem = height * 0.42;
    const glm::dvec3 crown = foot + glm::dvec3(0, 0, height - radius * 1.02);
    const glm::dvec3 lean((chance(1) - 0.5) * 0.5, (chance(2) - 0.5) * 0.5, stem + 0.5);
    model.add(Patch::tube(foot, lean, 0.17 + 0.01 * height, 0.11), bark, 1.2);
    for (int i = 0; i < 4; ++i) {
        const double turn = 1.57 * i + chance(3 + i);
        const glm::dvec3 reach(std::cos(turn) * radius * 0.6, std::sin(turn) * radius * 0.6, radius * 0.8);
        model.add(Patch::tube(foot + lean * 0.88, reach, 0.09, 0.04), bark, 1);
    }
    const Material* leaves =
        model.add<LeafMaterial>(rgb(greens[salt % greens.size()]), glm::vec3(crown), float(radius), salt);
    constexpr int clusters = 15;
    for (int i = 0; i < clusters; ++i) {
        // Evenly spread over a ball, by the golden angle; each a little astray.
        const double z = 1 - 2 * (i + 0.5) / clusters, turn = 2.39996 * i + salt, r = std::sqrt(1 - z * z);
        const double away = radius * (0.55 + 0.18 * chance(10 + i)),
                     size = radius * (0.36 + 0.14 * chance(30 + i));
        const glm::dvec3 at = crown + glm::dvec3(r * std::cos(turn), r * std::sin(turn), z * 0.95) * away;
        model.add(Patch::ball(at, size), leaves, leafDensity).hasNormal = false;
    }
    model.occluders.push_back(Occluder::leaves(crown, float(radius * 0.95)));
}

}  // namespace

void addTrees(Model& model) {
    const Material* bark = model.add<BarkMaterial>();
    std::uint32_t salt = 1;
    const auto plant = [&](double x, double y, double height, double radius) {
        const double scale = 0.85 + 0.3 * hashUnit(int(salt), 0, 43);
        addTree(model, {x, y, pavementHeight}, height * scale, radius * scale, salt, bark);
        ++salt;
    };
    for (const double x : {-17.5, -8.0, 8.0, 17.5}) plant(x, 14.5, 7.5, 2.3);
    for (const double x : {-18.0, 18.0}) plant(x, -12.5, 7.2, 2.2);
    for (const double y : {-3.0, 6.0}) {
        plant(-19, y, 7.2, 2.2);
        plant(19, y, 7.2, 2.2);
    }
    for (const double x : {-16.5, 16.5})
        for (const double y : {29.0, 38.0, 47.0, 56.0}) plant(x, y, 8.5, 2.6);
    for (int row = 0; row < townBlocks; ++row) {
        for (int column = 0; column < townBlocks; ++column) {
            if (column == 2 && (row == 2 || row == 3)) continue;
            const TownBlock block = townBlock(column, row);
            const double x = std::clamp((block.x0 + block.x1) / 2, -91.0, 91.0),
                         y = std::clamp((block.y0 + block.y1) / 2, -91.0, 91.0);
            const bool edge = column == 0 || column == 4 || row == 0 || row == 4;
            plant(x - 3.2, y + 1.8, 7, 2.4);
            if (!edge || column == 2) plant(x + 3.4, y - 1.9, 6, 2.1);
        }
    }
}

}  // namespace scancast
