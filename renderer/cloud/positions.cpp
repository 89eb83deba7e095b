#include "renderer/cloud/positions.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace scancast {

std::optional<std::array<std::int64_t, 3>> StepGrid::stepsIn(const StepGrid& other) const {
    if (step != other.step) return std::nullopt;
    std::array<std::int64_t, 3> between{};
    for (int a = 0; a < 3; ++a) {
        const double steps = (origin[a] - other.origin[a]) / step[a];
        const double whole = std::nearbyint(steps);
        // Half of what the builder allows a position to lie beside its grid; and both origins fine enough to say so.
        const double finest = 1e-4 * step[a] * 0x1p52;
        if (!(std::abs(steps - whole) <= 5e-4) || !(std::abs(whole) <= 0x1p32) ||
            !(std::max(std::abs(origin[a]), std::abs(other.origin[a])) <= finest))
            return std::nullopt;
        between[std::size_t(a)] = std::int64_t(whole);
    }
    return between;
}

std::array<glm::dvec3, 2> boundsOf(const Positions& positions) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<glm::dvec3, 2> bounds{glm::dvec3(infinity), glm::dvec3(-infinity)};
    if (positions.empty()) return bounds;
    if (!positions.areSteps()) {
        for (const glm::dvec3& p : positions.asDoubles())
            bounds = {glm::min(bounds[0], p), glm::max(bounds[1], p)};
        return bounds;
    }
    // A larger number is never a smaller coordinate: rounding keeps the order.
    GridSteps low = positions.asSteps().front(), high = low;
    for (const GridSteps& s : positions.asSteps())
        for (std::size_t a = 0; a < 3; ++a)
            low[a] = std::min(low[a], s[a]), high[a] = std::max(high[a], s[a]);
    return {positions.grid().at(low), positions.grid().at(high)};
}

}  // namespace scancast
