// The surface at each point of a frame, quickly: normals and distances of neighbours from what the cells of a grid
// know of their points, instead of from each point's own neighbours (renderer/cloud/surfels/, about ten times the
// work). Pure function; uses the caller's TBB arena; the same on any number of threads. Pipeline: order → **surface**
// → octree of a frame. Source: docs/spec/surfels.md §13.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "renderer/cloud/build/frame/frame_order.hpp"

namespace scancast {

/// What all points of one cell are told.
struct CellSurface {
    glm::vec3 normal{0};  ///< unit length; 0 where the points tell none
    float spacing = 0;    ///< distance of neighbours on a square grid as dense as these points; > 0
};

struct FrameSurface {
    std::vector<std::uint32_t> cellBegin;  ///< in the order; and the end
    std::vector<CellSurface> cells;

    /// The cell of a position of the order.
    std::size_t cellAt(std::size_t at) const;
};

/// `scanner`, cloud-relative: normals point to it; without it their sides are arbitrary.
FrameSurface estimateFrameSurface(const FrameOrder& order, const std::optional<glm::dvec3>& scanner);

}  // namespace scancast
