// The samples of an octree's nodes, as the store has them now: asked for once each, and held while this
// lives. Owned by one call of provide() and its like; used on its thread.
#pragma once

#include <optional>
#include <stop_token>
#include <unordered_map>
#include <utility>
#include <vector>

#include "renderer/cloud/octree.hpp"

namespace scancast {

class NodeRuns {
  public:
    explicit NodeRuns(const Octree& octree) : octree_(octree) {}

    /// Somebody has them already.
    void give(std::uint32_t node, SampleRun run) { found_[node].run = std::move(run); }
    bool has(std::uint32_t node);
    /// Expects has(node).
    const SampleRun& run(std::uint32_t node) const { return *found_.at(node).run; }
    /// It was tried, here or by somebody else, and its block cannot be read.
    bool damaged(std::uint32_t node) const;
    /// Loads those that are not here. Cancelled is the only error that stays one; others mark the node.
    Expected<void> load(const std::vector<std::uint32_t>& nodes, const std::stop_token& stop);

  private:
    struct Found {
        std::optional<SampleRun> run;
        bool damaged = false;
    };
    const Octree& octree_;
    std::unordered_map<std::uint32_t, Found> found_;
};

}  // namespace scancast
