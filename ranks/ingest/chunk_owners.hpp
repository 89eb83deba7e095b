// Which rank builds which chunk: neighbours in the order of the tree together, each rank about as many points. Plain values and pure
// functions. Pipeline: chunk layout → **owners** → points to their owners, subtrees.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/cloud/build/chunks/chunk_layout.hpp"
#include "renderer/cloud/build/nodes/build_node.hpp"

namespace scancast {

class ChunkOwners {
  public:
    static constexpr int nobodyAlone = -1;

    /// The same on all ranks.
    ChunkOwners(const ChunkLayout& layout, int ranks);

    int operator[](std::uint32_t chunk) const { return owner_[chunk]; }
    /// First of a rank's chunks, and one behind its last.
    std::uint32_t firstOf(int rank) const { return first_[std::size_t(rank)]; }
    std::uint32_t endOf(int rank) const { return first_[std::size_t(rank) + 1]; }
    /// Who owns all chunks below a set of the layout, or nobodyAlone.
    int ownerBelow(const LayoutNode& node) const;

  private:
    std::vector<int> owner_;
    std::vector<std::uint32_t> first_;
};

/// A node all below which is one rank's, while its parent's is not.
struct OwnedTop {
    BuildNode* node = nullptr;
    int owner = 0;
};
/// The tree's top - as growTop() grew it -, taken apart: what belongs to one rank, in the order of the tree, and the nodes above, parents
/// first, which rank 0 fills.
struct DividedTop {
    std::vector<OwnedTop> owned;
    std::vector<BuildNode*> shared;
};
DividedTop divideTop(const LayoutNode& layout, BuildNode& root, const ChunkOwners& owners);

}  // namespace scancast
