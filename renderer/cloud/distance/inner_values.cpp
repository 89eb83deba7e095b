#include "renderer/cloud/distance/inner_values.hpp"

#include <cmath>
#include <limits>

#include "renderer/cloud/distance/point_tree.hpp"

namespace scancast {

std::vector<float> nearestBelow(std::span<const glm::dvec3> places, std::span<const ValuedSamples> below) {
    ValuedSamples all;
    for (const ValuedSamples& child : below) {
        all.places.insert(all.places.end(), child.places.begin(), child.places.end());
        all.values.insert(all.values.end(), child.values.begin(), child.values.end());
    }
    const PointTree tree(all.places);
    std::vector<float> values;
    values.reserve(places.size());
    std::uint32_t last = 0;
    for (const glm::dvec3& place : places) {
        // What was nearest to the place before is not far. Only what is nearer is looked for, or as near.
        const double squared = squaredLength(all.places[last] - place);
        last = tree.firstNearest(
            place, {.squared = std::nextafter(squared, std::numeric_limits<double>::infinity())});
        values.push_back(all.values[last]);
    }
    return values;
}

}  // namespace scancast
