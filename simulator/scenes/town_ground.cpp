// Streets with markings and kerbs, pavements, the cobbled square, lawns behind the houses: one relief over
// the plan.
#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

constexpr std::array<double, 10> edgesX{-140, -73, -66.5, -28.5, -22, 22, 28.5, 66.5, 73, 140};
constexpr std::array<double, 10> edgesY{-140, -67, -60.5, -24.5, -18, 18, 24.5, 60.5, 67, 140};
constexpr double pavementWidth = 2.5, kerbWidth = 0.22, cornerRadius = 3.5;
/// How far a kerb's face leans back: points are even as seen from above, so a steeper face would be a gap in
/// them.
constexpr double kerbFace = 0.12;
constexpr std::uint8_t roadClass = 11;

/// The block that a coordinate belongs to, in the middle of streets the nearer one.
int blockAt(const std::array<double, 10>& edges, double at) {
    int block = 0;
    while (block < townBlocks - 1 &&
           at > (edges[std::size_t(2 * block + 1)] + edges[std::size_t(2 * block + 2)]) / 2)
        ++block;
    return block;
}

/// Signed distance to a rectangle with round corners; negative inside.
double blockDistance(const TownBlock& block, double x, double y) {
    const double dx = std::abs(x - (block.x0 + block.x1) / 2) - (block.x1 - block.x0) / 2 + cornerRadius;
    const double dy = std::abs(y - (block.y0 + block.y1) / 2) - (block.y1 - block.y0) / 2 + cornerRadius;
    return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0) - cornerRadius;
}

/// How far from the middle of the nearest street that runs along the other axis.
double streetOffset(const std::array<double, 10>& edges, double at) {
    double nearest = 1e9;
    for (std::size_t i = 1; i + 1 < edges.size(); i += 2) {
        const double offset = at - (edges[i] + edges[i + 1]) / 2;
        if (std::abs(offset) < std::abs(nearest)) nearest = offset;
    }
    return nearest;
}

class GroundMaterial final : public Material {
  public:
    void apply(const Patch&, SurfacePoint& point) const override {
        const double x = point.position.x, y = point.position.y;
        const TownBlock block = townBlock(blockAt(edgesX, x), blockAt(edgesY, y));
        const double d = blockDistance(block, x, y);
        point.classification = groundClass;
        if (d > 0) {
            road(point, x, y, d);
            return;
        }
        point.position.z += pavementHeight * std::min(1.0, -d / kerbFace);
        if (d > -kerbWidth) {
            kerb(point, d, x + y);
        } else if (d > -pavementWidth) {
            pavement(point, x, y);
        } else if (block.column == 2 && (block.row == 2 || block.row == 3)) {
            square(point, x, y, block.row == 2);
        } else {
            lawn(point, x, y);
        }
    }
    double relief() const override { return pavementHeight + 0.05; }

  private:
    static void road(SurfacePoint& point, double x, double y, double toKerb) {
        const glm::vec2 at{float(x), float(y)};
        const float patchy = smoothNoise(at * 0.35F, 1), fine = smoothNoise(at * 2.3F, 2);
        const float tone =
            0.335F + 0.07F * (patchy - 0.5F) + 0.04F * (fine - 0.5F) + 0.03F * (point.random->unit() - 0.5F);
        point.color = glm::vec3(tone, tone, tone * 1.03F);
        point.reflectance = 0.22F;
        point.classification = roadClass;
        point.raise(0.02 * (toKerb > 1 ? 1 : toKerb));
        // Mended places and the seams around them.
        const int px = int(std::floor(x / 9)), py = int(std::floor(y / 7));
        if (hashUnit(px, py, 3) < 0.16F && std::fmod(std::abs(x), 9.0) < 4 &&
            std::fmod(std::abs(y), 7.0) < 2.5)
            point.color *= 0.8F;
        if (toKerb < 0.35) point.color *= 0.86F;
        marks(point, streetOffset(edgesX, x), streetOffset(edgesY, y), x, y);
    }

    static void marks(SurfacePoint& point, double ox, double oy, double x, double y) {
        constexpr double half = 3.25, dash = 0.07;
        const bool inNorthSouth = std::abs(ox) < half, inEastWest = std::abs(oy) < half;
        if (inNorthSouth == inEastWest) {
            manhole(point, ox - 0.8, oy + 0.6);
            return;
        }
        const double across = inNorthSouth ? ox : oy, along = inNorthSouth ? oy : ox;
        const double run = inNorthSouth ? y : x;
        const double fromCorner = std::abs(along) - half;
        if (fromCorner > 1.9 && fromCorner < 5 && std::abs(across) < 3) {
            if ((int(std::floor((across + 30) / 0.55)) & 1) == 0) paint(point);
        } else if (fromCorner > 5.5 && fromCorner < 5.85 && (across > 0.2) == ((along > 0) == inEastWest)) {
            paint(point);
        } else if (fromCorner > 6.5 && std::abs(across) < dash && run - 5 * std::floor(run / 5) < 2.6) {
            paint(point);
        } else if (fromCorner > 6.5) {
            const double place = run - 17 * std::floor(run / 17);
            manhole(point, across - 1.1, place - 8);
        }
    }

    static void paint(SurfacePoint& point) {
        const glm::vec2 at(float(point.position.x) * 5, float(point.position.y) * 5);
        const float worn = smoothNoise(at, 5);
        point.color =
            blend(point.color, glm::vec3(0.93F, 0.92F, 0.88F), 0.65F + 0.35F * std::min(1.0F, worn * 1.6F));
        point.reflectance = 0.85F;
    }

    static void manhole(SurfacePoint& point, double dx, double dy) {
        const double r = std::hypot(dx, dy);
        if (r > 0.36) return;
        const bool rib = ((int(std::floor(dx * 14)) + int(std::floor(dy * 14))) & 1) != 0;
        point.color = glm::vec3(r > 0.31 ? 0.22F : rib ? 0.36F : 0.27F) * glm::vec3(1, 0.96F, 0.9F);
        point.reflectance = 0.4F;
    }

    static void kerb(SurfacePoint& point, double d, double run) {
        const int stone = int(std::floor(run / 0.9));
        const float tone =
            0.66F + 0.08F * (hashUnit(stone, 0, 6) - 0.5F) + 0.03F * (point.random->unit() - 0.5F);
        point.color = glm::vec3(tone, tone * 0.985F, tone * 0.95F) * (d > -kerbFace ? 0.8F : 1.0F);
        point.reflectance = 0.5F;
    }

    static void pavement(SurfacePoint& point, double x, double y) {
        constexpr double slab = 0.6;
        const int row = int(std::floor(y / slab));
        const double shifted = x + (row & 1) * slab / 2;
        const int column = int(std::floor(shifted / slab));
        const double u = shifted / slab - column, v = y / slab - row;
        float tone =
            0.60F + 0.09F * (hashUnit(column, row, 7) - 0.5F) + 0.03F * (point.random->unit() - 0.5F);
        tone += 0.06F * (smoothNoise({float(x) * 0.4F, float(y) * 0.4F}, 8) - 0.5F);
        const double joint = std::min(std::min(u, 1 - u), std::min(v, 1 - v)) * slab;
        if (joint < 0.014) tone *= 0.72F;
        point.color = glm::vec3(tone, tone * 0.975F, tone * 0.93F);
        point.reflectance = 0.42F;
    }

    static void square(SurfacePoint& point, double x, double y, bool fountain) {
        constexpr double stone = 0.16;
        const double r = std::hypot(x, y);
        double u = x / stone, v = y / stone;
        const bool ring = fountain && r < 9;
        if (ring) {  // laid in circles around the fountain
            v = r / stone;
            u = std::atan2(y, x) * std::max(1.0, std::floor(v)) * 1.0;
        } else if (int(std::floor(v)) & 1) {
            u += 0.5;
        }
        const int column = int(std::floor(u)), row = int(std::floor(v));
        const float hue = hashUnit(column, row, 9);
        const float tone = 0.52F + 0.17F * (hue - 0.5F) + 0.03F * (point.random->unit() - 0.5F);
        const double edge = std::min(std::min(u - column, column + 1 - u), std::min(v - row, row + 1 - v));
        point.color = blend(glm::vec3(tone * 1.04F, tone * 0.96F, tone * 0.86F), glm::vec3(tone),
                            hashUnit(row, column, 10));
        const double bandX = std::abs(x - 6 * std::round(x / 6)), bandY = std::abs(y - 6 * std::round(y / 6));
        const bool pale = ring ? std::abs(r - 5.2) < 0.3 || r > 8.6 : std::min(bandX, bandY) < 0.22;
        if (pale) point.color = glm::vec3(0.74F, 0.71F, 0.64F) * (0.94F + 0.12F * hue);
        if (edge < 0.1) point.color *= 0.74F;
        point.raise(edge < 0.1 ? -0.008 : 0.004 * hue);
        point.reflectance = pale ? 0.6F : 0.4F;
    }

    static void lawn(SurfacePoint& point, double x, double y) {
        const glm::vec2 at{float(x), float(y)};
        const float meadow = smoothNoise(at * 0.25F, 11), tuft = smoothNoise(at * 3.7F, 12),
                    blade = point.random->unit();
        const glm::vec3 fresh = blend(rgb(0x5d8a35), rgb(0x92a24a), meadow);
        point.color = fresh * (0.72F + 0.3F * tuft + 0.18F * (blade - 0.5F));
        const float flower = hashUnit(int(std::floor(x * 6)), int(std::floor(y * 6)), 13);
        if (flower > 0.992F && meadow > 0.45F) point.color = flower > 0.996F ? rgb(0xf4e04d) : rgb(0xf6f1ee);
        point.raise(0.045 * blade * tuft);
        point.openness = 0.7F + 0.3F * blade;
        point.reflectance = 0.62F;
        // A gravel path around each yard.
        if (std::abs(smoothNoise(at * 0.11F, 14) - 0.5F) < 0.022F) {
            point.color = glm::vec3(0.72F, 0.66F, 0.55F) * (0.88F + 0.2F * blade);
            point.openness = 1;
        }
    }
};

}  // namespace

TownBlock townBlock(int column, int row) {
    const auto c = std::size_t(2 * column), r = std::size_t(2 * row);
    return {edgesX[c], edgesY[r], edgesX[c + 1], edgesY[r + 1], column, row};
}

void addGround(Model& model) {
    const Material* ground = model.add<GroundMaterial>();
    constexpr double half = 100, tile = 10;
    for (double y = -half; y < half; y += tile)
        for (double x = -half; x < half; x += tile)
            model.add(Patch::trapezoid({x, y, 0}, {tile, 0, 0}, {0, tile, 0}), ground).hideInside = true;
}

}  // namespace scancast
