// A corridor along a folded line in plan, and where in it a point is: what a profile is made of. Immutable; read from any
// thread. Pipeline: points → **corridor** → writer, profile's picture.
//
// A point belongs to the segment of the line that it is nearest to, the earlier one where two are equally near. Its *station*
// is the distance along the line from its first corner to the place of the line that it is nearest to; its *offset* the
// distance from there, positive to the right of who walks along. On the outside of a fold the nearest place is the corner:
// there the corridor is round, without a gap, and all of it has the corner's station. At its two ends it is cut off square.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct CorridorPlace {
    double station = 0, offset = 0;  ///< file units
};

class Corridor {
  public:
    /// InvalidArgument, as checkLine() says it (points_request.hpp).
    static Expected<Corridor> create(const std::vector<glm::dvec2>& line, double width);

    double length() const { return length_; }
    double width() const { return 2 * half_; }

    /// Nothing where it is outside: farther than half the width, or before the line's beginning or behind its end.
    std::optional<CorridorPlace> place(const glm::dvec2& p) const { return place(p, all_); }
    /// The same by some of the segments: those that segmentsNear() names for a box that the point is in.
    std::optional<CorridorPlace> place(const glm::dvec2& p, std::span<const std::uint32_t> segments) const;
    /// All segments that points of this rectangle may belong to; none: it is outside.
    std::vector<std::uint32_t> segmentsNear(const glm::dvec2& low, const glm::dvec2& high) const;

  private:
    struct Segment {
        glm::dvec2 from, to, along;  ///< along: unit vector
        double length = 0, station = 0;
    };

    std::vector<Segment> segments_;
    std::vector<std::uint32_t> all_;
    double half_ = 0, length_ = 0;
};

}  // namespace scancast
