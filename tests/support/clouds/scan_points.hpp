// All positions of a scan, as estimateSurfels() wants them: offsets from a nearby origin.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

inline Expected<std::vector<glm::vec3>> readPositions(PointSource& source) {
    std::vector<glm::vec3> points;
    glm::dvec3 origin{0};
    PointBatch batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) return points;
        if (points.empty()) origin = batch.position.front();
        for (const glm::dvec3& p : batch.position) points.emplace_back(p - origin);
    }
}

}  // namespace scancast::test
