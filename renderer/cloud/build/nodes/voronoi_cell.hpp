// The Voronoi cell of the origin in the plane, cut out of a square neighbour by neighbour.
#pragma once

#include <array>
#include <glm/vec2.hpp>

namespace scancast {

class VoronoiCell {
  public:
    /// Starts as the square [-halfSide, halfSide]².
    explicit VoronoiCell(double halfSide);
    /// Takes away what is nearer to the neighbour than to the origin.
    void cut(const glm::dvec2& neighbour);
    /// Square of the distance of the cell's farthest corner.
    double squaredReach() const { return squaredReach_; }
    double area() const;
    /// Whether part of the square's border is left: the cell is not bounded by neighbours alone.
    bool isOpen() const;

  private:
    struct Corner {
        glm::dvec2 at;
        bool square;  ///< the edge from here to the next corner belongs to the square
    };
    std::array<Corner, 64> corners_;
    int count_ = 4;
    double squaredReach_;
};

}  // namespace scancast
