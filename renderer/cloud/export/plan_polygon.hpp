// A polygon in plan, made ready to be asked of many points: its edges, by the bands of y that they cross.
// Immutable; read from any thread. Pipeline: region → **polygon** → leaves, points.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "protocol/points/points_region.hpp"

namespace scancast {

/// Where a box lies: what is inside need not be looked at point by point, and what is outside not at all.
enum class Within : std::uint8_t { Outside, Across, Inside };

class PolygonTest {
  public:
    /// A polygon that checkPolygon() has found sound.
    explicit PolygonTest(const PlanPolygon& polygon);

    /// As PlanPolygon says it, in doubles; the same for an edge whichever of its polygons asks.
    bool contains(const glm::dvec2& p) const;
    /// Of a rectangle; Across where an edge touches it, or may.
    Within of(const glm::dvec2& low, const glm::dvec2& high) const;

  private:
    struct Edge {
        glm::dvec2 low, high;  ///< low.y ≤ high.y
        double slope = 0;      ///< x for each y; of horizontal ones 0
    };

    std::size_t bandOf(double y) const;
    /// Whether any edge has a place in common with a rectangle.
    bool anyTouches(const glm::dvec2& low, const glm::dvec2& high) const;

    std::vector<Edge> edges_;
    std::vector<std::vector<std::uint32_t>> bands_;  ///< edges, some in several
    std::vector<std::size_t> entriesBefore_{0};      ///< in the bands before each one, and in all
    glm::dvec2 low_{0}, high_{0};
    double bandsPerUnit_ = 0;
};

}  // namespace scancast
