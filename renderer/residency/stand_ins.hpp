// Ancestors that are drawn for what is not at hand - in the machine's memory, or on the GPU - and what is
// asked for instead. Pure functions of the cut and of what is at hand. Pipeline: select → provide(), and
// once more where a device has memory of its own (on_device.hpp).
#pragma once

#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "renderer/cloud/octree.hpp"
#include "renderer/select/select.hpp"

namespace scancast {

/// Whether a node's samples are at hand.
using AtHand = std::function<bool(std::uint32_t node)>;

/// The wanted runs that are at hand, and for those that are not the nearest ancestors that are, as provide()
/// promises. Runs that are new have no samples yet. Whoever counts what is missing is told of each wanted run
/// that is not at hand.
Cut withStandIns(const Octree& octree, Cut wanted, const AtHand& atHand,
                 const std::function<void(Cut&, const CutRun&)>& missing);

/// Nodes that runs need and that are not at hand, each with its missing ancestors up to the first that is.
class BlockRequests {
  public:
    BlockRequests(const Octree& octree, const AtHand& atHand) : octree_(octree), atHand_(atHand) {}

    /// Urgent as the node's spacing is large on screen, and `offset` more: coarser ones first.
    void add(std::span<const CutRun> runs, double offset = 0);
    /// Most urgent first.
    std::vector<BlockRequest> sorted() const;

  private:
    const Octree& octree_;
    const AtHand& atHand_;
    std::unordered_map<std::uint32_t, double> urgencies_;
};

}  // namespace scancast
