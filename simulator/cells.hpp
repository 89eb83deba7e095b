// Cuts a model's patches into cells of about equal size and deals the points out to them, so that every place
// gets its share whatever the number of points - no holes - and each point's number tells which cell it
// belongs to. Cells stand in the order in which the scanner meets them: station, then azimuth, then
// elevation.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/model.hpp"

namespace scancast {

struct Cell {
    std::uint32_t patch = 0;
    std::uint16_t column = 0, row = 0;
    std::uint16_t station = 0;
    std::uint8_t shadowCount = 0, nearCount = 0;  ///< occluders that may shade it; that may dim its sky
    std::uint32_t firstOccluder = 0;  ///< into CellTable::occluders: shadows first, then near ones
};

class CellTable {
  public:
    /// Throws std::bad_alloc only.
    static CellTable build(const Model& model, std::uint64_t points);

    std::size_t size() const { return cells_.size(); }
    const Cell& cell(std::size_t index) const { return cells_[index]; }
    std::uint64_t firstPoint(std::size_t cell) const { return first_[cell]; }
    /// The cell that holds this point; never an empty one.
    std::size_t cellOf(std::uint64_t point) const;

    std::uint32_t columns(std::uint32_t patch) const { return grid_[patch].columns; }
    std::uint32_t rows(std::uint32_t patch) const { return grid_[patch].rows; }
    std::uint32_t occluder(std::uint32_t slot) const { return occluders_[slot]; }
    /// Typical distance of neighbouring points where the density is 1.
    double spacing() const { return spacing_; }

  private:
    struct Grid {
        std::uint32_t columns = 1, rows = 1;
    };

    std::vector<Grid> grid_;  ///< one a patch
    std::vector<Cell> cells_;
    std::vector<std::uint64_t> first_;  ///< size() + 1 entries
    std::vector<std::uint32_t> guide_;  ///< a first guess for cellOf
    std::vector<std::uint32_t> occluders_;
    std::uint64_t points_ = 0;
    double spacing_ = 0;
};

/// How the beam sees a place: azimuth and elevation as parts of a turn in [0, 1).
struct BeamAngles {
    double azimuth = 0, elevation = 0;
};
BeamAngles beamAngles(const glm::dvec3& fromStation);

/// Where a mirrored point seems to be.
glm::dvec3 reflected(const Mirror& mirror, const glm::dvec3& at);

}  // namespace scancast
