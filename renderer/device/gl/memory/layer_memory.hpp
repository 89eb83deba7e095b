// What the GPU is told of a layer: tables that the host makes anew for every picture, in buffers that live as
// long as the device, since making buffers takes a driver longer than filling them. They are filled through a
// mapped ring (staging_ring.hpp), in order with the dispatches around it: the picture before may still be
// read from them. Owned by a GL device; inside a Current scope of its context.
#pragma once

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include "renderer/device/gl/memory/splat_params.hpp"
#include "renderer/device/gl/memory/staging_ring.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {

/// One layer's tables (splat_layouts.hpp). The ring outlives them.
struct LayerMemory {
    LayerMemory(const GlFunctions& gl, StagingRing& filledThrough)
        : ring(filledThrough),
          runs(gl, "runs", Buffer::Use::Copies),
          lookUps(gl, "tables", Buffer::Use::Copies),
          rows(gl, "background", Buffer::Use::Copies),
          chunks(gl, "chunks", Buffer::Use::Copies),
          extents(gl, "extents", Buffer::Use::Copies) {}

    /// Fills a table from its beginning, with room for more, so that it grows seldom. ResourceLimit,
    /// DeviceLost.
    template <class T>
    Expected<void> fill(Buffer& table, const std::vector<T>& values) {
        constexpr std::size_t smallest = 4096;
        const auto bytes = std::as_bytes(std::span(values));
        if (auto ok = table.reserve(std::bit_ceil(std::max(bytes.size(), smallest))); !ok) return ok;
        return ring.copy(bytes, table, 0);
    }

    StagingRing& ring;
    Buffer runs, lookUps, rows, chunks, extents;
    // The host's side of them, whose memory is used again, too.
    SplatTables host;
    std::vector<SplatChunk> chunkList;
    std::vector<SplatExtent> extentList;
};

}  // namespace scancast::gl
