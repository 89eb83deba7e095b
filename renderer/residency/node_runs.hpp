// The samples of an octree's nodes, as the store has them now: asked for once each, and held while this
// lives. Nodes are found by their number, without a search. Owned by one call of provide() and its like; used
// on its thread.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "renderer/cloud/octree.hpp"

namespace scancast {

class NodeRuns {
  public:
    explicit NodeRuns(const Octree& octree) : octree_(octree), places_(octree.nodes().size(), notAsked) {}

    /// Somebody has them already.
    void give(std::uint32_t node, SampleRun run) { found(node).run = std::move(run); }
    /// Asks for all that have not been asked for, at once.
    void ask(std::span<const std::uint32_t> nodes);
    bool has(std::uint32_t node);
    /// Expects has(node).
    const SampleRun& run(std::uint32_t node) const { return *found_[places_[node]].run; }
    /// It was tried, here or by somebody else, and its block cannot be read.
    bool damaged(std::uint32_t node) const;
    /// Loads those that are not here. Cancelled and Unavailable stay errors; others mark the node.
    Expected<void> load(std::span<const std::uint32_t> nodes, const std::stop_token& stop);

  private:
    static constexpr std::uint32_t notAsked = noNode;
    struct Found {
        std::optional<SampleRun> run;
        bool damaged = false;
    };
    /// As asked for from now on.
    Found& found(std::uint32_t node);

    const Octree& octree_;
    std::vector<std::uint32_t> places_;  ///< in found_, by node
    std::vector<Found> found_;
};

}  // namespace scancast
