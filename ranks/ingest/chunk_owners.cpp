#include "ranks/ingest/chunk_owners.hpp"

#include <algorithm>

namespace scancast {

namespace {

void divideBelow(const LayoutNode& layout, BuildNode& node, const ChunkOwners& owners, DividedTop& top) {
    if (const int owner = owners.ownerBelow(layout); owner != ChunkOwners::nobodyAlone) {
        top.owned.push_back({&node, owner});
        return;
    }
    top.shared.push_back(&node);
    for (std::size_t i = 0; i < layout.children.size(); ++i)
        divideBelow(layout.children[i], *node.children[i], owners, top);
}

}  // namespace

ChunkOwners::ChunkOwners(const ChunkLayout& layout, int ranks) {
    std::uint64_t rest = 0;
    for (const ChunkLayout::Chunk& chunk : layout.chunks) rest += chunk.points;
    // Each takes its part of what is left, to the chunk boundary that is nearest.
    int rank = 0;
    std::uint64_t taken = 0, wanted = rest / unsigned(ranks);
    for (const ChunkLayout::Chunk& chunk : layout.chunks) {
        if (taken > 0 && rank + 1 < ranks && taken + chunk.points / 2 > wanted) {
            rest -= taken;
            taken = 0;
            ++rank;
            wanted = rest / unsigned(ranks - rank);
        }
        owner_.push_back(rank);
        taken += chunk.points;
    }
    for (int r = 0; r <= ranks; ++r)
        first_.push_back(std::uint32_t(std::ranges::lower_bound(owner_, r) - owner_.begin()));
}

int ChunkOwners::ownerBelow(const LayoutNode& node) const {
    if (node.children.empty()) return owner_[node.chunk];
    const int first = ownerBelow(node.children.front()), last = ownerBelow(node.children.back());
    return first == last ? first : nobodyAlone;  // owners ascend in the order of the tree
}

DividedTop divideTop(const LayoutNode& layout, BuildNode& root, const ChunkOwners& owners) {
    DividedTop top;
    divideBelow(layout, root, owners, top);
    return top;
}

}  // namespace scancast
