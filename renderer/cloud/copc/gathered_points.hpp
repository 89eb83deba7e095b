// What is drawn of each voxel of an additive tree: its own points and those of the voxels above that lie in it. What inner nodes have
// is kept for their children, least recently used out; whoever wants what somebody else is gathering waits for that.
// Owned by a native cloud. *Thread safety*: every function may be called from any thread. Pipeline: raw points → **gathered** → samples.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <unordered_map>

#include "renderer/cloud/copc/raw_points.hpp"
#include "threads/monitor.hpp"

namespace scancast {

class GatheredPoints {
  public:
    /// The own points of a voxel, which has some. Waits for what they come from.
    using OwnPoints = std::function<Expected<RawPoints>(std::uint32_t voxel)>;

    /// `tree`, `frame` and what `own` needs live as long as this. `bytes`: of what is kept.
    GatheredPoints(const AdditiveTree& tree, const CopcHierarchy& hierarchy, const AdditiveFrame& frame,
                   std::uint64_t bytes, OwnPoints own);

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

    const AdditiveTree& tree_;
    const CopcHierarchy& hierarchy_;
    const AdditiveFrame& frame_;
    const std::uint64_t limit_;
    const OwnPoints own_;
    mutable Monitor monitor_;  // guards what follows
    std::unordered_map<std::uint32_t, Kept> kept_;
    std::list<std::uint32_t> uses_;  // of what is here, the last used first
    std::uint64_t bytes_ = 0;
};

}  // namespace scancast
