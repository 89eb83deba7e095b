// Points in portions are counted, and sorted by the chunk that they belong to. Pipeline: staging → **counted → sorted** → chunks. Uses
// the caller's TBB arena.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/cloud/build/chunks/chunk_layout.hpp"
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

/// Points that go to one chunk: its own, with their rows, or of its halo.
struct ChunkRun {
    std::uint32_t chunk = 0;
    bool halo = false;
    std::span<const BuildPoint> points;
    std::span<const std::byte> rows;
};

/// Takes what is sorted. *Thread safety*: any thread, at any time.
class ChunkTaker {
  public:
    virtual ~ChunkTaker() = default;
    virtual Expected<void> take(const ChunkRun& run) = 0;
};

/// Chunks that fill up, places in them being handed out to whoever brings points.
class ChunkFiller final : public ChunkTaker {
  public:
    explicit ChunkFiller(std::size_t rowBytes);
    /// Makes room for chunks first … last - 1 of the layout; no others may be brought. Errors: the workspace's.
    Expected<void> begin(const ChunkLayout& layout, std::size_t first, std::size_t last,
                         Workspace& workspace);
    Expected<void> take(const ChunkRun& run) override;
    /// In the order of the layout. Internal where points are missing.
    Expected<std::vector<Chunk>> finish();

  private:
    struct Filling {
        Chunk chunk;
        std::atomic<std::uint64_t> nextPoint{0}, nextHalo{0};
    };
    const std::size_t rowBytes_;
    std::size_t first_ = 0;
    std::vector<std::unique_ptr<Filling>> fillings_;
};

/// Portions sorted together, so that what goes to one chunk's place on the disk is worth a write.
inline constexpr std::size_t portionsAtOnce = 8;

/// Errors: the portions'; Cancelled.
Expected<CountingGrid> countPoints(const PointPortions& portions, const GridBox& box,
                                   const std::stop_token& stop);

/// Gives portions begin … end - 1 to the chunks of the layout, and releases them; `together` at a time by one thread. Errors: the portions'
/// and the taker's; Cancelled.
Expected<void> sortIntoChunks(PointPortions& portions, std::size_t begin, std::size_t end,
                              const ChunkLayout& layout, std::size_t rowBytes, ChunkTaker& taker,
                              ProgressMeter& progress, const std::stop_token& stop,
                              std::size_t together = portionsAtOnce);

}  // namespace scancast
