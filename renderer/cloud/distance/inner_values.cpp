#include "renderer/cloud/distance/inner_values.hpp"

#include <cmath>
#include <limits>

#include "renderer/cloud/distance/point_tree.hpp"

namespace scancast {

ValuedPoints nearestBelow(std::span<const glm::dvec3> samples, std::span<const ValuedPoints> below) {
    ValuedPoints all;
    for (const ValuedPoints& child : below) {
        all.places.insert(all.places.end(), child.places.begin(), child.places.end());
        all.values.insert(all.values.end(), child.values.begin(), child.values.end());
    }
    const PointTree tree(all.places);
    ValuedPoints chosen;
    chosen.places.reserve(samples.size());
    chosen.values.reserve(samples.size());
    PointTree::Nearest nearest;
    for (const glm::dvec3& sample : samples) {
        // What was nearest to the sample before is not far. As far as that: whichever would be found without.
        if (!chosen.places.empty())
            nearest.squared = std::nextafter(squaredLength(chosen.places.back() - sample),
                                             std::numeric_limits<double>::infinity());
        tree.findNearer(sample, nearest);
        chosen.places.push_back(tree.point(nearest.place));
        chosen.values.push_back(all.values[tree.index(nearest.place)]);
    }
    return chosen;
}

}  // namespace scancast
