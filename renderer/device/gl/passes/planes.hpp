// The pixels of a layer on the GPU: what splats are resolved into, what screen passes change in place, what
// is read back. Buffers belong to the picture and outlive these references. Pipeline: layer → **planes** →
// screen passes → frame.
#pragma once

#include <cstddef>
#include <glm/ext/vector_int4.hpp>

#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {

/// Storage buffers of one word a pixel, `area` of the whole picture row by row.
struct GpuPlanes {
    /// x, y, width, height, px. With a guard band every coordinate is shifted by it, so none is negative.
    glm::ivec4 area{0};
    Buffer* rgba = nullptr;     ///< r | g << 8 | b << 16 | a << 24
    Buffer* depth = nullptr;    ///< floats, linear; +infinity = background
    Buffer* normals = nullptr;  ///< as cpu/kernels/normal_plane.hpp packs them, 0 = none; null: not wanted

    std::size_t pixels() const { return static_cast<std::size_t>(area.z) * static_cast<std::size_t>(area.w); }
};

}  // namespace scancast::gl
