// A polygon in plan view as cells of a square raster, each with the exact share of it that lies in the polygon. Pure; any thread.
// Pipeline: corners → **raster** → volume.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

namespace scancast {

class PlanRaster {
  public:
    /// How many columns and rows the raster would have; in doubles, for there may be too many for anything else.
    static glm::dvec2 sizeOf(std::span<const glm::dvec2> corners, double cell);

    /// Three or more corners that enclose something without crossing, in either order, in whose bounds the raster begins; sides of
    /// cells > 0. Memory: a float a cell.
    PlanRaster(std::vector<glm::dvec2> corners, double cell);

    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return rows_; }
    std::size_t cells() const { return columns_ * rows_; }
    double cell() const { return cell_; }
    /// Of the polygon, 0 to 1.
    double share(std::size_t cell) const { return double(shares_[cell]); }
    glm::dvec2 middle(std::size_t cell) const {
        return low_ + cell_ * (glm::dvec2(double(cell % columns_), double(cell / columns_)) + 0.5);
    }
    /// The cell that a point within the polygon lies in; nullopt for one outside.
    std::optional<std::size_t> cellOf(const glm::dvec2& point) const;

  private:
    void addEdge(std::vector<double>& sums, glm::dvec2 from, glm::dvec2 to) const;
    bool isInside(const glm::dvec2& point) const;

    std::vector<glm::dvec2> corners_;  ///< relative to low_
    glm::dvec2 low_{0};
    double cell_;
    std::size_t columns_ = 0, rows_ = 0;
    std::vector<float> shares_;  ///< row by row
};

}  // namespace scancast
