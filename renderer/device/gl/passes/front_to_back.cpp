#include "renderer/device/gl/passes/front_to_back.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "renderer/device/host/splats.hpp"

namespace scancast::gl {
namespace {

/// Depth of the nearest that a node may hold, within what may be drawn.
float frontOf(const Node& node, const Viewpoint& viewpoint) {
    const glm::dmat4& m = viewpoint.cloudToView;
    const double depth =
        -(m[0][2] * node.center.x + m[1][2] * node.center.y + m[2][2] * node.center.z + m[3][2]);
    return static_cast<float>(
        std::clamp(depth - node.radius, 0.0, std::min(viewpoint.far, double(farthestDepth))));
}

}  // namespace

/// By one count.
std::vector<std::uint32_t> frontToBack(const Cut& cut, std::span<const DrawnRun> runs,
                                       const Viewpoint& viewpoint) {
    constexpr std::size_t steps = 1024;
    if (runs.empty()) return {};
    std::vector<float> depths;
    depths.reserve(runs.size());
    for (const DrawnRun& drawn : runs) depths.push_back(frontOf(*cut.runs[drawn.run].node, viewpoint));
    const auto [first, last] = std::ranges::minmax(depths);
    const double scale = last > first ? (steps - 1) / (double(last) - first) : 0;
    const auto stepOf = [&, first = double(first)](float depth) {
        return static_cast<std::size_t>((depth - first) * scale);
    };
    std::array<std::uint32_t, steps + 1> begins{};
    for (const float depth : depths) ++begins[stepOf(depth) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<std::uint32_t> sorted(runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) sorted[begins[stepOf(depths[i])]++] = runs[i].run;
    return sorted;
}

}  // namespace scancast::gl
