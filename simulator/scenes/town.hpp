// The parts of the town scene. The town is always the same; what the seed changes is where it is sampled.
#pragma once

#include <optional>
#include <string>

#include "simulator/model.hpp"

namespace scancast {

/// Afternoon sun from the south-south-east, where it lights the two sides that the first view shows.
inline const glm::vec3 townSun = glm::normalize(glm::vec3(0.42F, -0.70F, 0.74F));

inline constexpr double pavementHeight = 0.12;

/// A block between streets, its pavement included.
struct TownBlock {
    double x0, y0, x1, y1;
    int column, row;  ///< 0 … 4; the square is (2, 2)
};
inline constexpr int townBlocks = 5;
TownBlock townBlock(int column, int row);

void addGround(Model& model);
/// Whole rows of houses around all blocks but the square, and the church.
void addHouses(Model& model);
void addTrees(Model& model);
/// Lamp posts, cars, market stalls, benches, the fountain and the sign.
void addStreetFurniture(Model& model);

/// A house on a rectangle, its front along `along` from `corner`; outwards is to the right of `along`.
struct HouseStyle {
    glm::vec3 wall{0.8F}, trim{0.9F}, frame{0.95F}, roof{0.6F, 0.3F, 0.2F}, shutter{0.3F, 0.4F, 0.3F},
        door{0.3F};
    int storeys = 3, columns = 3;
    double groundHeight = 3.4, storeyHeight = 3.0;
    double windowWidth = 1.1, windowHeight = 1.55, sillHeight = 0.85;
    bool shutters = false, brick = false, quoins = false, arched = false;
    std::string shop;  ///< what its sign reads; empty = no shop
    std::uint32_t salt = 0;
    double height() const { return groundHeight + (storeys - 1) * storeyHeight + 0.45; }
};

struct Opening {
    enum class Kind : std::uint8_t { Window, Door, ShopWindow };
    Kind kind = Kind::Window;
    double x0 = 0, x1 = 0, y0 = 0, y1 = 0, depth = 0.16;
};

/// Walls with everything on them: a relief over the patch's plane.
class FacadeMaterial final : public Material {
  public:
    FacadeMaterial(const HouseStyle& style, double width, bool front, glm::vec3 along, glm::vec3 outwards);
    void apply(const Patch& patch, SurfacePoint& point) const override;
    double relief() const override { return 0.25; }
    /// What is in a column of a storey (0 = ground floor).
    std::optional<Opening> opening(int column, int storey) const;
    int columns() const { return style_.columns; }
    int storeys() const { return style_.storeys; }

  private:
    void wall(SurfacePoint& point) const;
    void bands(SurfacePoint& point) const;
    void aroundOpening(const Opening& opening, SurfacePoint& point) const;
    void window(const Opening& opening, SurfacePoint& point, std::uint64_t id) const;
    void door(const Opening& opening, SurfacePoint& point) const;
    void shopWindow(const Opening& opening, SurfacePoint& point) const;
    void shopSign(SurfacePoint& point) const;
    /// Darkens what the edges of a recess, or the eaves, keep from the sun.
    void shade(const Opening& opening, double depth, SurfacePoint& point) const;

    HouseStyle style_;
    double width_, columnWidth_;
    bool front_;
    double sunAlong_, sunUp_, sunOut_;
};

void addHouse(Model& model, const HouseStyle& style, glm::dvec3 corner, glm::dvec3 along, double width,
              double depth, double backDensity);
void addChurch(Model& model, glm::dvec3 center);

}  // namespace scancast
