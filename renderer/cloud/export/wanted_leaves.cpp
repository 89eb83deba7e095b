// Which leaves a region or a corridor needs, and which of them as a whole.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/file/exact_places.hpp"

namespace scancast {
namespace {

/// Inside only where it is so for any class.
Within placeOf(const CloudPointsOptions& options, const std::array<glm::dvec3, 2>& reach) {
    if (options.corridor &&
        options.corridor->segmentsNear(glm::dvec2(reach[0]), glm::dvec2(reach[1])).empty())
        return Within::Outside;
    const Within region = options.region ? options.region->of(reach[0], reach[1]) : Within::Inside;
    return options.corridor && region == Within::Inside ? Within::Across : region;
}

}  // namespace

std::array<glm::dvec3, 2> reachOf(const CloudFile& file, const Node& node) {
    const glm::dvec3 origin = file.facts().origin;
    const glm::dvec3 margin = node.step + 1e-9 * (glm::abs(node.boxMax) + glm::abs(origin));
    return {origin + node.boxMin - margin, origin + node.boxMax + margin};
}

std::vector<WantedLeaf> wantedLeaves(const CloudFile& file, const CloudPointsOptions& options) {
    struct Open {
        std::uint32_t node;
        bool inside;
    };
    // Numbers of what is shown as it is are estimates.
    const bool known = !file.countsVary() && !(options.region && options.region->hasClasses());
    std::vector<WantedLeaf> leaves;
    std::vector<Open> open;
    if (!file.nodes().empty()) open.push_back({0, !options.region && !options.corridor});
    while (!open.empty() && !options.stop.stop_requested()) {
        auto [index, inside] = open.back();
        open.pop_back();
        const Node& node = file.nodes()[index].node;
        if (!inside) {
            const Within place = placeOf(options, reachOf(file, node));
            if (place == Within::Outside) continue;
            inside = place == Within::Inside;
        }
        if (node.isLeaf()) leaves.push_back({index, inside && known});
        for (std::uint32_t c = node.childCount; c-- > 0;) open.push_back({node.firstChild + c, inside});
    }
    return leaves;
}

RoundedPoints roundedPoints(const CloudFile& file, const CloudPointsOptions& options) {
    const CloudFacts& facts = file.facts();
    RoundedPoints rounded;
    if (facts.exact) return rounded;
    for (const WantedLeaf& leaf : wantedLeaves(file, options)) {
        const Node& node = file.nodes()[leaf.node].node;
        if (!roundsPositions(node, facts.grid)) continue;
        rounded.points += node.sampleCount;
        for (int a = 0; a < 3; ++a)
            if (roundsPositions(node, facts.grid, a))
                rounded.most[a] = std::max(rounded.most[a], node.step[a] / 2);
    }
    return rounded;
}

}  // namespace scancast
