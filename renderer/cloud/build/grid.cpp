#include "renderer/cloud/build/grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scancast {

double Grid::cellSize(int cellLevel) const {
    return std::ldexp(std::max({step.x, step.y, step.z}), cellLevel);
}

Grid ownGrid(const glm::dvec3& origin, const glm::dvec3& ownStep, const std::array<std::int64_t, 3>& low,
             const std::array<std::int64_t, 3>& high) {
    Grid grid;
    const double finest = std::min({ownStep.x, ownStep.y, ownStep.z});
    for (int a = 0; a < 3; ++a) {
        const int room = gridBits - int(std::bit_width(std::uint64_t(high[a] - low[a])));
        const int wanted = int(std::lround(std::min(std::log2(ownStep[a] / finest), 64.0)));
        grid.ownShift[a] = std::clamp(wanted, 0, std::max(room, 0));
        grid.step[a] = std::ldexp(ownStep[a], -grid.ownShift[a]);
        grid.corner[a] = origin[a] + ownStep[a] * double(low[a]);
    }
    return grid;
}

Grid cubicGrid(const glm::dvec3& low, const glm::dvec3& high) {
    Grid grid;
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    // One point, or many at one place: any step will do; this one is a micrometre where the unit is a metre.
    const double step =
        extent > 1e-25 ? std::ldexp(1.0, std::ilogb(extent) + 2 - gridBits) : std::ldexp(1.0, -20);
    grid.corner = low;
    grid.step = glm::dvec3(step);
    return grid;
}

glm::dvec3 roundOrigin(const std::array<glm::dvec3, 2>& bounds) {
    const glm::dvec3 size = bounds[1] - bounds[0];
    const double largest = std::max({size.x, size.y, size.z});
    const int digits = largest > 0 ? std::clamp(int(std::floor(std::log10(largest))), -6, 15) : 0;
    const double unit = std::pow(10.0, std::abs(digits));
    glm::dvec3 origin;
    for (int a = 0; a < 3; ++a)
        origin[a] =
            digits >= 0 ? std::floor(bounds[0][a] / unit) * unit : std::floor(bounds[0][a] * unit) / unit;
    return origin + 0.0;  // no -0
}

}  // namespace scancast
