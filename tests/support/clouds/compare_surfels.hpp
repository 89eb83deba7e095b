// How well surfels agree with a reference's, counted where the two mean the same: as many neighbours, and no
// choice between neighbours that are equally far. Used by the oracle test and the benchmark.
#pragma once

#include <glm/geometric.hpp>

#include <cmath>

#include "renderer/cloud/surfels/surfels.hpp"
#include "tests/support/clouds/surfel_references.hpp"

namespace scancast::test {

struct Agreement {
    std::size_t compared = 0, normals = 0, radii = 0;
    std::size_t doubled = 0, tied = 0;  ///< left out, and why
    double share(std::size_t n) const { return compared ? double(n) / double(compared) : 0; }
};

/// Normals within 1° up to sign, radii within 1 %.
inline Agreement compare(std::span<const Surfel> ours, std::span<const ReferenceSurfel> theirs) {
    Agreement a;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        if (theirs[i].lineRatio < 1.0 / 16) {
            ++a.doubled;
        } else if (theirs[i].tie) {
            ++a.tied;
        } else {
            ++a.compared;
            const glm::dvec3 n(ours[i].normal), m(theirs[i].normal);
            const double angle =
                std::atan2(glm::length(glm::cross(n, m)), std::abs(glm::dot(n, m))) * 57.29577951308232;
            a.normals += glm::length(n) > 0 && angle <= 1;
            a.radii += std::abs(ours[i].radius - theirs[i].radius) <= 0.01f * theirs[i].radius;
        }
    }
    return a;
}

}  // namespace scancast::test
