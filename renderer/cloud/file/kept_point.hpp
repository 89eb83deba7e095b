// One point of a scan, with everything that a cloud file keeps of it: what somebody who points at it wants to read. Plain value.
// Pipeline: cloud file → **kept point** → pick.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct KeptPoint {
    glm::dvec3 position{0};  ///< file coordinates
    /// How finely coordinates are told apart there, on each axis: the step of the scan's grid; of float64 coordinates that are kept,
    /// the distance of neighbouring numbers; of rounded ones, the step that they were rounded to.
    glm::dvec3 precision{0};
    bool exact = false;                ///< position is the scan's own, to the last bit
    std::optional<glm::dvec3> normal;  ///< the scan's own, where it is kept beside the sample
    std::vector<Column> columns;       ///< but for those that position and normal come out of
    std::vector<std::byte> row;        ///< of rowBytes(columns)
};

}  // namespace scancast
