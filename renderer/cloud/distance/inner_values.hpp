// What values a column's inner nodes have: a sample there stands for many points, and has the value of one of them, the nearest, as it is
// found by way of the nodes between. It is the same point whose values ingest gives it of other columns (build/nodes/inner_columns.hpp).
// Pure functions. Pipeline: values of leaves → **inner values** → companion of the column.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace scancast {

/// A node's samples: where they are, cloud-relative, and their values.
struct ValuedSamples {
    std::vector<glm::dvec3> places;
    std::vector<float> values;
};

/// For each place of an inner node's samples the value of the sample below that is nearest, of equally near ones the first. `below`: of
/// the node's children, in their order, at least one sample.
std::vector<float> nearestBelow(std::span<const glm::dvec3> places, std::span<const ValuedSamples> below);

}  // namespace scancast
