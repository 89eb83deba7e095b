// One point of a simulated scan as a pure function of its number: what makes scans of any length stream, in
// any order, on any number of threads, with the same result.
#pragma once

#include "simulator/cells.hpp"

namespace scancast {

struct ScanPoint {
    glm::dvec3 position{0};  ///< relative to the scene's origin
    glm::vec3 normal{0};
    std::array<std::uint8_t, 3> color{};
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    std::uint64_t beam = 0;  ///< when the scanner meets it: station, scan line, angle on the line
};

class Sampler {
  public:
    Sampler(const Model& model, std::uint64_t points, std::uint64_t seed, double noise)
        : model_(model),
          cells_(CellTable::build(model, points)),
          points_(points),
          seed_(seed),
          noise_(noise) {}

    /// `index` < points. Safe from all threads at once.
    ScanPoint point(std::uint64_t index) const;
    const CellTable& cells() const { return cells_; }

  private:
    SurfacePoint surfacePoint(std::size_t cellIndex, std::uint64_t index, PointRandom& random) const;
    SurfacePoint regularPoint(const Cell& cell, std::size_t cellIndex, std::uint64_t index,
                              PointRandom& random) const;
    void record(const Cell& cell, const glm::dvec3& seen, float facing, const SurfacePoint& surface,
                PointRandom& random, ScanPoint& out) const;

    const Model& model_;
    CellTable cells_;
    std::uint64_t points_, seed_;
    double noise_;
};

}  // namespace scancast
