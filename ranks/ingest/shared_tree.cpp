#include "ranks/ingest/shared_tree.hpp"

#include "ranks/ingest/archive.hpp"
#include "renderer/cloud/build/nodes/subtree.hpp"

namespace scancast {

namespace {

constexpr int averagesTag = 1;
/// Deeper trees than gridBits and all averages allow are none.
constexpr int deepest = 128;

/// All of a node that others have to know, in the order in which it is written and read.
template <class Node, class Visit>
void forNode(Node& node, Visit visit) {
    visit(node.pointCount);
    visit(node.box);
    visit(node.content.corner);
    visit(node.content.step);
    visit(node.content.bounds);
    visit(node.content.spacing);
    visit(node.content.meanSpacing);
    visit(node.content.cellLevel);
    visit(node.content.cone);
    visit(node.stored.node.sampleCount);
    visit(node.stored.samples);
    visit(node.columns);
    visit(node.positions);
    visit(node.beside);
    visit(node.sampleHash);
    visit(node.confidence);
    visit(node.surePoints);
}

void packBelow(const BuildNode& node, BytesOut& out) {
    out(std::uint8_t(node.children.size()));
    forNode(node, [&](const auto& value) { out(value); });
    for (const auto& child : node.children) packBelow(*child, out);
}

bool unpackBelow(BytesIn& in, BuildNode& node) {
    const int children = in.get<std::uint8_t>();
    if (children > 8 || node.level > deepest) return false;
    forNode(node, [&](auto& value) { in(value); });
    node.children.clear();
    for (int c = 0; c < children && in.isSound(); ++c) {
        BuildNode& child = *node.children.emplace_back(std::make_unique<BuildNode>());
        child.level = node.level + 1;
        child.parent = &node;
        if (!unpackBelow(in, child)) return false;
    }
    return in.isSound();
}

tl::unexpected<Error> notUnderstood() {
    return fail(ErrorCode::Internal, "A part of the tree arrived that is none.");
}

/// What the parent of a finished node needs of it beside what all know.
RankBytes packAverages(BuildNode& node) {
    BytesOut out;
    out(node.content.cells);
    out(node.averages.cellLevel);
    out(node.averages.averages);
    out(node.averages.votes);
    out(node.keptPoints);
    out(node.isLeaf() ? node.content.beside : std::vector<BesideWord>());
    node.averages = {};
    node.points = {};
    giveBack(node.keptPoints);
    giveBack(node.content.beside);
    return out.take();
}

Expected<void> unpackAverages(std::span<const std::byte> bytes, BuildNode& node) {
    BytesIn in(bytes);
    in(node.content.cells);
    in(node.averages.cellLevel);
    in(node.averages.averages);
    in(node.averages.votes);
    in(node.keptPoints);
    in(node.content.beside);
    node.points = node.keptPoints;
    return in.finish();
}

/// Rank 0: the nodes above all that somebody owns, from the averages of these, in the order of the tree.
Expected<void> fillShared(const DividedTop& top, const OctreeInput& input, Workspace& workspace,
                          const Communicator& ranks) {
    Expected<void> done;
    for (const OwnedTop& owned : top.owned) {
        if (owned.owner == 0) continue;  // its own have been counted by who finished them
        std::uint64_t size = 0;
        if (auto ok = ranks.receive(std::as_writable_bytes(std::span(&size, 1)), owned.owner, averagesTag);
            !ok)
            return ok;
        RankBytes bytes(size);
        if (auto ok = ranks.receive(bytes, owned.owner, averagesTag); !ok) return ok;
        if (done) done = unpackAverages(bytes, *owned.node);
        if (done) done = averageUpwards(*owned.node, input, workspace, true);
    }
    return done;
}

Expected<void> sendAverages(const DividedTop& top, const Communicator& ranks) {
    for (const OwnedTop& owned : top.owned) {
        if (owned.owner != ranks.rank()) continue;
        const RankBytes bytes = packAverages(*owned.node);
        std::uint64_t size = bytes.size();
        if (auto ok = ranks.send(std::as_bytes(std::span(&size, 1)), 0, averagesTag); !ok) return ok;
        if (auto ok = ranks.send(bytes, 0, averagesTag); !ok) return ok;
    }
    return {};
}

}  // namespace

Expected<void> shareTree(const DividedTop& top, const OctreeInput& input, Workspace& workspace,
                         const Communicator& ranks) {
    Expected<void> done;
    for (int teller = 0; teller < ranks.size(); ++teller) {  // no rank has more than one other's at once
        const bool isOwn = teller == ranks.rank();
        BytesOut told;
        for (const OwnedTop& owned : top.owned)
            if (isOwn && owned.owner == teller) packBelow(*owned.node, told);
        RankBytes bytes = told.take();
        if (auto ok = ranks.broadcast(bytes, teller); !ok) return ok;
        if (isOwn) continue;
        BytesIn in(bytes);
        for (const OwnedTop& owned : top.owned) {
            if (owned.owner != teller || !done) continue;
            if (!unpackBelow(in, *owned.node)) done = notUnderstood();
            forEachNode(*owned.node, [&](BuildNode&) { workspace.occupy(bytesOfNode(input)); });
        }
        if (done) done = in.finish();
    }
    if (auto ok = ranks.agree(done); !ok) return ok;

    done = ranks.isFirst() ? fillShared(top, input, workspace, ranks) : sendAverages(top, ranks);
    if (auto ok = ranks.agree(done); !ok) return ok;
    BytesOut filled;
    if (ranks.isFirst())
        for (const BuildNode* node : top.shared) forNode(*node, [&](const auto& value) { filled(value); });
    RankBytes shared = filled.take();
    if (auto ok = ranks.broadcast(shared); !ok) return ok;
    BytesIn from(shared);
    for (BuildNode* node : top.shared) forNode(*node, [&](auto& value) { from(value); });
    return ranks.agree(from.finish());
}

NumberedTree::NumberedTree(BuildNode& root, const DividedTop& top) {
    std::unordered_map<const BuildNode*, int> owners;
    for (const OwnedTop& owned : top.owned) owners[owned.node] = owned.owner;
    forEachNode(root, [&](BuildNode& node) {
        const auto own = owners.find(&node);
        // Above what somebody owns everything is rank 0's; below it, its parent's.
        int owner = 0;
        if (own != owners.end())
            owner = own->second;
        else if (node.parent)
            owner = owners_[numbers_.at(node.parent)];
        numbers_[&node] = std::uint32_t(nodes_.size());
        nodes_.push_back(&node);
        owners_.push_back(owner);
    });
}

}  // namespace scancast
