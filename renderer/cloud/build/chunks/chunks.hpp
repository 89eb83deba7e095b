// Chunks: sets of neighbouring points, each small enough to become a subtree in memory. Pipeline: staging →
// counting grid → chunk plan → **chunks** → octree builder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/cloud/build/chunks/chunk_plan.hpp"
#include "renderer/cloud/build/nodes/build_node.hpp"
#include "renderer/cloud/build/progress_meter.hpp"
#include "renderer/cloud/build/workspace.hpp"

namespace scancast {

/// Points in portions: what can be counted and divided. Portions may be read from any thread.
class PointPortions {
  public:
    struct Portion {
        std::vector<BuildPoint> points;
        std::vector<std::byte> rows;
    };
    virtual ~PointPortions() = default;
    virtual std::size_t size() const = 0;
    /// Replaces what `into` holds.
    virtual Expected<void> read(std::size_t index, Portion& into) const = 0;
    /// No longer needed: its room may be given back.
    virtual void release(std::size_t index) = 0;
};

/// One chunk's points, in no particular order, and where in the tree it belongs.
struct Chunk {
    BuildNode* root = nullptr;
    std::uint64_t points = 0, halo = 0;
    Workspace::Buffer pointBytes, haloBytes;  ///< BuildPoint each
    Workspace::Buffer rowBytes;               ///< rowBytes each, in the order of the points
};

struct ChunkOptions {
    std::uint64_t chunkPoints = 1 << 20;
    std::size_t rowBytes = 0;
    bool halo = false;
};

/// Counts and divides points that lie in `box`, and grows the top of the tree below `root`. Chunks that are
/// still too large, because their points crowd in one cell, are divided again. In the order of the tree. Uses
/// the caller's TBB arena. Errors: the portions' and the workspace's; ResourceLimit for very many points at
/// exactly one place; Cancelled.
Expected<std::vector<Chunk>> divide(PointPortions& portions, std::uint64_t points, const GridBox& box,
                                    BuildNode& root, const Grid& grid, const ChunkOptions& options,
                                    Workspace& workspace, ProgressMeter& progress,
                                    const std::stop_token& stop);

}  // namespace scancast
