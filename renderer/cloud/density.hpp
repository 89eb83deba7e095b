// What stands at a sample: how the points around it are strewn decides how large it may be drawn. Computed with
// the surfels (surfels/evidence.hpp), kept for every sample while a cloud is built. Source: docs/spec/surfels.md §8.
#pragma once

#include <cstdint>

namespace scancast {

/// The numbers are what files and shaders may know: they stay.
enum class Density : std::uint8_t {
    Surface,  ///< flat, and its neighbours say the same
    Edge,     ///< beside surfaces, but not flat: a crease, a border, a corner
    Wire,     ///< on a line with nothing beside it: wires, poles, the rings of a sweep
    Foliage,  ///< in a volume: leaves, spray, points with nothing in common
    Stray,    ///< alone or in a small group, far from everything: not drawn unless asked for
};

}  // namespace scancast
