#include "renderer/cloud/surfels/strays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace scancast {

namespace {

constexpr int others = surfel::mostWitnesses;  ///< whose radii say how dense it is where they stand
static_assert(mostStraysTogether + others <= surfel::maxNeighbours);

float distance(const NeighbourIndex& index, std::uint32_t a, std::uint32_t b) {
    return glm::length(index.position(a) - index.position(b));
}

float medianRadius(const Evidence& evidence, const std::uint32_t* who, int count) {
    std::array<float, others> radii{};
    for (int i = 0; i < count; ++i) radii[std::size_t(i)] = evidence.radius(who[i]);
    const auto middle = radii.begin() + (count - 1) / 2;
    std::nth_element(radii.begin(), middle, radii.begin() + count);
    return *middle;
}

/// Of a stray in a group of at most eight the far ones are among the ten nearest, and make distances long. Where
/// all are far, in one direction, they look like a line with nothing beside it; but on a line some are near.
bool looksLonely(std::uint32_t p, const Evidence& evidence) {
    float least = evidence.radius(p);
    if (evidence.witnesses(p).empty()) return 4 * evidence.nearby(p) > least;
    for (const std::uint32_t w : evidence.witnesses(p)) least = std::min(least, evidence.radius(w));
    return evidence.radius(p) > 2 * least || evidence.nearby(p) > 2 * least;
}

}  // namespace

bool isStray(std::uint32_t p, const NeighbourIndex& index, const Evidence& evidence,
             const surfel::SurfelKernels& kernels, surfel::SearchScratch& scratch) {
    const int found = kernels.nearest(index.view(), p, mostStraysTogether + others, scratch);
    float width = 0;
    for (int g = 1; g <= std::min(found, mostStraysTogether); ++g) {
        const float gap = std::sqrt(scratch.bestSquared[g]);
        if (gap > farFactor * width &&
            gap > farFactor * medianRadius(evidence, scratch.best + g, std::min(others, found - g + 1)))
            return true;
        width = gap;
    }
    return false;
}

void findStrays(std::uint32_t begin, std::uint32_t end, const NeighbourIndex& index, const Evidence& evidence,
                const surfel::SurfelKernels& kernels, surfel::SearchScratch& scratch,
                std::vector<std::uint32_t>& strays) {
    const std::uint32_t all = index.size();
    constexpr float endless = std::numeric_limits<float>::infinity();
    for (std::uint32_t first = begin; first < end; ++first) {
        const float before = first == 0 ? endless : distance(index, first - 1, first);
        glm::vec3 low = index.position(first), high = low;
        std::uint32_t asked = first;
        for (std::uint32_t last = first + 1;; ++last) {
            const glm::vec3 size = high - low;
            const float width = farFactor * std::max({size.x, size.y, size.z});
            if (!(before > width)) break;
            const float after = last == all ? endless : distance(index, last - 1, last);
            if (after > width && (last - first > others || looksLonely(first, evidence)))
                for (; asked < last; ++asked)
                    if (isStray(asked, index, evidence, kernels, scratch)) strays.push_back(asked);
            if (last == all || last - first == mostStraysTogether) break;
            low = glm::min(low, index.position(last));
            high = glm::max(high, index.position(last));
        }
        if (asked > first) first = asked - 1;
    }
}

}  // namespace scancast
