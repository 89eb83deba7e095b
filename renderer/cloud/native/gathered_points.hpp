// What is drawn of each voxel of an additive tree: its own points and those of the voxels above that lie in it. What inner nodes have
// is kept for their children, least recently used out; whoever wants what somebody else is gathering waits for that.
// Owned by a native cloud. *Thread safety*: every function may be called from any thread. Pipeline: raw points → **gathered** → samples.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "renderer/cloud/native/raw_points.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// What native clouds of a process keep together. *Thread safety*: every function may be called from any thread.
class GatheredMemory {
  public:
    using Reserve = std::function<std::shared_ptr<const void>(std::uint64_t bytes)>;
    /// `reserve` counts all of it, once something is kept, for as long as this lives.
    explicit GatheredMemory(std::uint64_t limit, Reserve reserve = {})
        : limit_(limit), reserve_(std::move(reserve)) {}
    std::uint64_t limit() const { return limit_; }
    bool isFull() const;
    /// What one cloud may keep however much others have: some 8 MB, or its part of the limit where there are many.
    std::uint64_t floor() const;
    void join();  ///< one cloud more
    void leave();
    void take(std::uint64_t bytes);
    void giveBack(std::uint64_t bytes);

  private:
    const std::uint64_t limit_;
    const Reserve reserve_;
    mutable std::mutex mutex_;  // guards what follows
    std::uint64_t bytes_ = 0, clouds_ = 0;
    std::shared_ptr<const void> reserved_;
};

class GatheredPoints {
  public:
    /// The own points of a voxel, which has some. Waits for what they come from.
    using OwnPoints = std::function<Expected<RawPoints>(std::uint32_t voxel)>;

    /// `tree`, `frame` and what `own` needs live as long as this.
    GatheredPoints(const AdditiveTree& tree, const VoxelTree& hierarchy, const AdditiveFrame& frame,
                   std::shared_ptr<GatheredMemory> memory, OwnPoints own);
    ~GatheredPoints();
    GatheredPoints(const GatheredPoints&) = delete;
    GatheredPoints& operator=(const GatheredPoints&) = delete;

    /// Errors: those of the own points of the node, or of one above; ResourceLimit, where more lie in one voxel than any has.
    Expected<RawPoints> of(std::uint32_t node);
    /// The voxels whose points of() would ask for now.
    std::vector<std::uint32_t> missingFor(std::uint32_t node) const;

  private:
    struct Kept {
        RawPoints points{};  ///< null while it is being gathered
        std::list<std::uint32_t>::iterator use{};
    };
    Expected<RawPoints> gather(std::uint32_t node);
    void keep(std::uint32_t node, RawPoints points);
    void take(std::uint64_t bytes);
    void giveBack(std::uint64_t bytes);

    const AdditiveTree& tree_;
    const VoxelTree& hierarchy_;
    const AdditiveFrame& frame_;
    const std::shared_ptr<GatheredMemory> memory_;
    const OwnPoints own_;
    mutable Monitor monitor_;  // guards what follows
    std::unordered_map<std::uint32_t, Kept> kept_;
    std::list<std::uint32_t> uses_;  // of what is here, the last used first
    std::uint64_t bytes_ = 0;
};

}  // namespace scancast
