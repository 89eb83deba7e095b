// A facet: what a few dozen neighbouring points of one patch have in common. All facets of a cloud fit in memory,
// whatever its size: sides are decided with them alone. Pipeline: leaves with patches → **facets** → sides.
// Source: docs/spec/surfels.md §9.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace scancast {

/// Of facets whose points are in no patch.
inline constexpr std::uint32_t loosePoints = 0xffffffffu;

struct Facet {
    glm::vec3 position{0};              ///< cloud-relative mean
    glm::vec3 normal{0};                ///< unit; to the patch's side
    float area = 0;                     ///< square cloud units
    std::uint32_t patch = loosePoints;  ///< in the whole cloud
};

/// A patch of a chunk, by the points it has.
struct PatchCount {
    std::uint64_t points = 0, links = 0, contradictions = 0;
};

/// All that two patches have to say of each other, in votes of links between points.
struct Border {
    std::uint32_t low, high;  ///< patches
    double same = 0, opposite = 0;
    double agreement() const { return std::abs(same - opposite) / (same + opposite); }
    double strength() const { return agreement() * std::abs(same - opposite); }
};

}  // namespace scancast
