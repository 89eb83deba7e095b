#include "renderer/cloud/native/node_surfels.hpp"

#include <glm/geometric.hpp>
#include <vector>

#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/cloud/surfels/sizes.hpp"
#include "renderer/cloud/surfels/surfels.hpp"

namespace scancast {

namespace {

/// Neighbours at least mostly agree on one: an oblique direction, which few surfaces of a built world are parallel to.
constexpr glm::vec3 commonSide(0.36f, 0.48f, 0.8f);

}  // namespace

void addNodeSurfels(const Node& node, std::span<Sample> samples) {
    if (samples.empty()) return;
    std::vector<glm::vec3> offsets;
    offsets.reserve(samples.size());
    for (const Sample& s : samples) offsets.emplace_back(node.step * glm::dvec3(s.x, s.y, s.z));
    const std::vector<float> spacings(samples.size(), node.spacing);
    std::vector<Surfel> surfels(samples.size());
    estimateSurfels(offsets, {.spacings = spacings, .layers = true}, surfels);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        Surfel& surfel = surfels[i];
        if (glm::dot(surfel.normal, commonSide) < 0) surfel.normal = -surfel.normal;
        shrink(surfel, largestRadius(surfel, surfel.density, node.radiusUnit));
        encodeSurfel(surfel, node.radiusUnit, samples[i]);
    }
}

}  // namespace scancast
