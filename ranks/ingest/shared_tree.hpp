// One tree out of everybody's subtrees: rank 0 fills the nodes above them, and then all ranks know all nodes - where they lie, how many
// samples they have -, though not the samples, which stay with who made them. Pipeline: subtrees → **shared tree** → inner surfels.
#pragma once

#include <unordered_map>
#include <vector>

#include "ranks/ingest/chunk_owners.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// All ranks call it, their own subtrees being grown. Afterwards `root` is the whole tree; blocks' places are still those on their
/// owners' shelves. Errors: the workspace's, of any rank.
Expected<void> shareTree(const DividedTop& top, const OctreeInput& input, Workspace& workspace,
                         const Communicator& ranks);

/// The nodes of a whole tree by number, in a walk depth first: the same on all ranks.
class NumberedTree {
  public:
    NumberedTree(BuildNode& root, const DividedTop& top);

    std::size_t size() const { return nodes_.size(); }
    BuildNode& node(std::uint32_t number) { return *nodes_[number]; }
    std::uint32_t numberOf(const BuildNode& node) const { return numbers_.at(&node); }
    /// The rank that keeps its samples.
    int ownerOf(std::uint32_t number) const { return owners_[number]; }

  private:
    std::vector<BuildNode*> nodes_;
    std::vector<int> owners_;
    std::unordered_map<const BuildNode*, std::uint32_t> numbers_;
};

/// Samples of others' nodes that the surfels of this rank's inner nodes depend on are fetched, in rounds of bounded memory, into their
/// setAside. All ranks call it. Errors: the workspace's and the shelf's, of any rank.
/// `bytesAtOnce`, the same on all ranks: so much is sent in a round, and as much comes, but for the last node of each.
Expected<void> fetchNeighbours(NumberedTree& tree, std::span<BuildNode* const> own, const BlockSink& shelf,
                               Workspace& workspace, std::uint64_t bytesAtOnce, const Communicator& ranks);

}  // namespace scancast
