// How light falls on a surface point: sun or lamp with shadows, sky from above, light thrown back from below.
// One function for the sampler, which scans, and the ray caster, which knows how the scan should look.
#pragma once

#include "simulator/cells.hpp"

namespace scancast {

/// The point's colour in this light; `cell` says which occluders may matter (nullptr: none).
glm::vec3 lit(const Model& model, const CellTable& cells, const Cell* cell, const Patch& patch,
              const SurfacePoint& point);

}  // namespace scancast
