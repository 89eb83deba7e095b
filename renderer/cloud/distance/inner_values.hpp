// What values a column's inner nodes have: a sample there stands for many points, and has the value of the one that is nearest to it,
// as it is found by way of the nodes between. Pure functions. Pipeline: values of leaves → **inner values** → companion of the column.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace scancast {

/// The scan's points that a node's samples stand for, in the samples' order: a leaf's are its own. Where, and their values.
struct ValuedPoints {
    std::vector<glm::dvec3> places;
    std::vector<float> values;
};

/// Of an inner node whose samples are at `samples`, in the same frame; `below`: of its children, in their order, at least one point.
ValuedPoints nearestBelow(std::span<const glm::dvec3> samples, std::span<const ValuedPoints> below);

}  // namespace scancast
