#include "renderer/cloud/build/octree_builder.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <mutex>

#include "renderer/cloud/build/chunks/kept_rows.hpp"
#include "renderer/cloud/build/finish.hpp"
#include "renderer/cloud/build/nodes/set_aside.hpp"
#include "renderer/cloud/build/nodes/subtree.hpp"
#include "renderer/cloud/build/sides/chunk_sides.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/normal_cone.hpp"

namespace scancast {

namespace {

/// Itself, its parent's pointer to it, and what it becomes when the tree is finished.
constexpr std::uint64_t nodeBytes =
    sizeof(BuildNode) + 4 * sizeof(void*) + 2 * (sizeof(StoredNode) + sizeof(void*));
/// And for each column: a leaf's own place, the finished tree's, its record; and the last two of inner nodes' plane.
constexpr std::uint64_t columnBytes = 5 * sizeof(BlockPlace);

struct LeafBlocks {
    BuildNode* leaf = nullptr;
    std::vector<std::byte> samples;
    std::vector<std::vector<std::byte>> columns;
    std::vector<std::vector<std::byte>> positions;
    BesideBlocks beside;
};

/// A chunk on its way through the stages.
struct Work {
    std::size_t number = 0;
    Chunk chunk;
    ChunkSides sides;
    std::vector<BuildPoint> loaded;
    std::vector<LeafBlocks> blocks;
    Expected<void> result;
    std::exception_ptr thrown;
};

/// One run of the builder: chunk after chunk becomes a subtree, several at once; what is finished leaves in
/// the order of the tree.
class TreeBuilder {
  public:
    TreeBuilder(const OctreeInput& input, Workspace& workspace, BlockSink* file, const SidesOfPatches& decide,
                ProgressMeter& progress, const std::stop_token& stop)
        : input_(input),
          workspace_(workspace),
          file_(file),
          decide_(decide),
          progress_(progress),
          stop_(stop) {}

    Expected<void> run(std::vector<Chunk> chunks, int lanes) {
        chunks_ = std::move(chunks);
        if (!input_.findSides)
            return forChunks(
                lanes, [this](Work& work) { return grow(work); },
                [this](Work& work) { return settle(work); });
        held_.resize(chunks_.size());
        auto done = forChunks(
            lanes, [this](Work& work) { return growWithoutSides(work); },
            [this](Work& work) { return hold(work); });
        // It is asked in any case: others may wait for the answer.
        auto sides = decide_(done, facets_, patches_, borders_);
        if (!sides) return passOn(sides);
        sides_ = std::move(*sides);
        giveBack(facets_);
        return forChunks(
            lanes, [this](Work& work) { return turn(work); }, [this](Work& work) { return settle(work); });
    }

    SureCount sure() const { return {points_, surePoints_}; }

  private:
    /// One chunk after the other through two stages: first several at once, then in the order of the tree. What a stage
    /// throws ends the run after the pipeline has: an exception within it would lose the chunks that are on their way.
    template <class First, class Then>
    Expected<void> forChunks(int lanes, First first, Then then) {
        std::size_t next = 0;
        Expected<void> result;
        std::exception_ptr thrown;
        tbb::parallel_pipeline(
            std::size_t(std::max(lanes, 1)),
            tbb::make_filter<void, Work*>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& control) -> Work* {
                                              if (next == chunks_.size() || failed_ ||
                                                  stop_.stop_requested()) {
                                                  control.stop();
                                                  return nullptr;
                                              }
                                              auto work = std::make_unique<Work>();
                                              work->number = next;
                                              work->chunk = std::move(chunks_[next++]);
                                              return work.release();
                                          }) &
                tbb::make_filter<Work*, Work*>(tbb::filter_mode::parallel,
                                               [&](Work* work) {
                                                   try {
                                                       work->result = first(*work);
                                                   } catch (...) {
                                                       work->thrown = std::current_exception();
                                                   }
                                                   if (work->thrown || !work->result) failed_ = true;
                                                   return work;
                                               }) &
                tbb::make_filter<Work*, void>(tbb::filter_mode::serial_in_order, [&](Work* done) {
                    const std::unique_ptr<Work> work(done);
                    if (!thrown) thrown = work->thrown;
                    if (thrown) return;
                    try {
                        if (result) result = work->result;
                        if (result) result = then(*work);
                    } catch (...) {
                        thrown = std::current_exception();
                    }
                    if (thrown || !result) failed_ = true;
                }));
        if (thrown) std::rethrow_exception(thrown);
        if (result && stop_.stop_requested())
            return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
        return result;
    }

    /// A chunk's points become a subtree. Runs beside others of its kind.
    Expected<void> grow(Work& work) {
        const auto patches = growLeaves(work);
        if (!patches) return passOn(patches);
        finishLeaves(work);
        return {};
    }

    /// The leaves alone, and what decides on which side they were scanned.
    Expected<void> growWithoutSides(Work& work) {
        const auto patches = growLeaves(work);
        if (!patches) return passOn(patches);
        auto sides = holdSides(*work.chunk.root, *patches, input_, workspace_);
        if (!sides) return passOn(sides);
        work.sides = std::move(*sides);
        forEachNode(*work.chunk.root, [&](BuildNode& n) {
            if (n.isLeaf()) progress_.add(n.points.size() - n.points.size() / 3);
        });
        return putBack(work);
    }

    /// Leaves that know their sides, and what is above them.
    Expected<void> turn(Work& work) {
        HeldChunk& held = held_[work.number];
        if (auto ok = load(work); !ok) return ok;
        BuildNode& root = *work.chunk.root;
        if (auto ok = takeSides(root, held.sides, sides_, held.firstPatch, input_); !ok) return ok;
        held.sides.surfels.clear();
        work.blocks.resize(held.leaves);
        finishLeaves(work);
        return {};
    }

    void finishLeaves(Work& work) {
        std::vector<BuildNode*> leaves;
        BuildNode& root = *work.chunk.root;
        forEachNode(root, [&](BuildNode& n) {
            if (n.isLeaf()) leaves.push_back(&n);
        });
        tbb::parallel_for(std::size_t(0), leaves.size(),
                          [&](std::size_t i) { finishLeaf(*leaves[i], work.blocks[i]); });
        fillBelow(root, input_);
    }

    Expected<SidePatches> growLeaves(Work& work) {
        Chunk& chunk = work.chunk;
        BuildNode& root = *chunk.root;
        if (auto ok = load(work); !ok) return passOn(ok);
        std::vector<std::byte> space;
        const auto rows = chunk.rowBytes.view(space);
        if (!rows) return passOn(rows);
        std::optional<KeptRows> kept;
        if (!input_.columns.empty() || input_.nearInfrared) kept.emplace(root.points, *rows, input_.rowBytes);

        scancast::grow(root, input_);
        std::vector<BuildNode*> leaves;
        forEachNode(root, [&](BuildNode& n) {
            if (n.isLeaf()) leaves.push_back(&n);
        });
        work.blocks.resize(leaves.size());
        if (kept && (file_ || input_.nearInfrared))
            tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
                const std::vector<std::byte> own = kept->rowsOf(leaves[i]->points);
                if (file_) work.blocks[i].columns = encodeColumns(own);
                if (input_.nearInfrared) leaves[i]->content.beside = takeNearInfrared(own);
            });
        kept.reset();
        if (input_.gridPlanes && file_)
            tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
                if (!isExact(leaves[i]->box, input_.grid))
                    work.blocks[i].positions = encodePositions(leaves[i]->points);
            });
        SidePatches patches;
        if (input_.shape.surfels) {
            std::vector<std::byte> haloSpace;
            const auto halo = chunk.haloBytes.view(haloSpace);
            if (!halo) return passOn(halo);
            patches = addLeafSurfels(
                root, std::span(reinterpret_cast<const BuildPoint*>(halo->data()), std::size_t(chunk.halo)),
                input_);
        }
        chunk.haloBytes.clear();
        chunk.rowBytes.clear();
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            work.blocks[i].leaf = leaves[i];
            leaves[i]->confidence = input_.oriented ? certainSide : 0;
            leaves[i]->surePoints = input_.oriented ? leaves[i]->points.size() : 0;
        }
        return patches;
    }

    std::vector<std::vector<std::byte>> encodeColumns(std::span<const std::byte> rows) const {
        std::vector<std::vector<std::byte>> blocks;
        for (const PlaceInRow& column : input_.columns)
            blocks.push_back(encodeRows(takeColumn(rows, column), column.bytes));
        return blocks;
    }

    std::vector<BesideWord> takeNearInfrared(std::span<const std::byte> rows) const {
        const std::vector<std::byte> bytes = takeColumn(rows, input_.nearInfrared->place);
        std::vector<BesideWord> beside(bytes.size() / sizeof(std::uint16_t));
        for (std::size_t i = 0; i < beside.size(); ++i) {
            std::uint16_t value;
            std::memcpy(&value, &bytes[i * sizeof value], sizeof value);
            beside[i] = withNearInfrared(0, std::uint8_t(value >> input_.nearInfrared->shift));
        }
        return beside;
    }

    /// As whole numbers of the scan's own grid, an axis after the other.
    std::vector<std::vector<std::byte>> encodePositions(std::span<const BuildPoint> points) const {
        std::vector<std::vector<std::byte>> blocks;
        std::vector<std::int32_t> values(points.size());
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t i = 0; i < points.size(); ++i)
                values[i] = std::int32_t(std::int64_t(points[i].axis(int(a)) >> input_.grid.ownShift[a]) +
                                         input_.ownLow[a]);
            blocks.push_back(encodeRows(std::as_bytes(std::span(values)), sizeof(std::int32_t)));
        }
        return blocks;
    }

    Expected<void> load(Work& work) {
        Chunk& chunk = work.chunk;
        if (std::byte* memory = chunk.pointBytes.memory()) {
            chunk.root->points = {reinterpret_cast<BuildPoint*>(memory), std::size_t(chunk.points)};
            return {};
        }
        work.loaded.resize(chunk.points);
        if (auto ok = chunk.pointBytes.read(0, std::as_writable_bytes(std::span(work.loaded))); !ok)
            return ok;
        if (!input_.findSides) chunk.pointBytes.clear();
        chunk.root->points = work.loaded;
        return {};
    }

    /// Points in the order of the leaves wait again.
    Expected<void> putBack(Work& work) {
        forEachNode(*work.chunk.root, [](BuildNode& n) { n.points = {}; });
        if (work.chunk.pointBytes.memory()) return {};
        return work.chunk.pointBytes.write(0, std::as_bytes(std::span(work.loaded)));
    }

    Expected<void> hold(Work& work) {
        HeldChunk& held = held_[work.number];
        held.firstPatch = std::uint32_t(patches_.size());
        held.leaves = work.blocks.size();
        for (Facet& f : work.sides.facets)
            if (f.patch != loosePoints) f.patch += held.firstPatch;
        facets_.insert(facets_.end(), work.sides.facets.begin(), work.sides.facets.end());
        patches_.insert(patches_.end(), work.sides.patches.begin(), work.sides.patches.end());
        for (Border b : work.sides.borders) {
            b.low += held.firstPatch;
            b.high += held.firstPatch;
            borders_.push_back(b);
        }
        giveBack(work.sides.borders);
        workspace_.occupy(work.sides.facets.size() * sizeof(Facet));
        giveBack(work.sides.facets);
        giveBack(work.sides.patches);
        held.sides = std::move(work.sides);
        for (LeafBlocks& blocks : work.blocks)
            if (auto ok = storeColumns(blocks); !ok) return ok;
        chunks_[work.number] = std::move(work.chunk);
        return {};
    }

    void finishLeaf(BuildNode& leaf, LeafBlocks& blocks) {
        const auto& samples = leaf.content.samples;
        leaf.content.cone = coneOfSamples(samples);
        leaf.sampleHash = hashOf(samples, leaf.content.beside);
        blocks.leaf = &leaf;
        points_ += leaf.points.size();
        if (leaf.confidence >= sureSide) surePoints_ += leaf.surePoints;
        if (file_) blocks.samples = encodeSamples(samples);
        if (file_) blocks.beside = encodeBeside(leaf.content.beside, input_);
        progress_.add(input_.findSides ? leaf.points.size() / 3 : leaf.points.size());
    }

    /// A finished subtree takes its place; one after the other, in the order of the tree.
    Expected<void> settle(Work& work) {
        BuildNode& root = *work.chunk.root;
        std::vector<BesideWord> ofRoot;  // a chunk that is one leaf is averaged later
        if (root.isLeaf() && input_.nearInfrared) ofRoot = root.content.beside;
        for (LeafBlocks& blocks : work.blocks)
            if (auto ok = store(blocks); !ok) return ok;
        if (!ofRoot.empty()) root.content.beside = std::move(ofRoot);
        Expected<void> result;
        forEachNode(root, [&](BuildNode& n) {
            workspace_.occupy(bytesOfNode(input_));
            if (n.isLeaf()) {
                if (&n != &root) n.points = {};
            } else {
                n.points = {};
                if (result && file_) result = setAside(n, workspace_);
            }
        });
        if (!result) return result;
        if (root.isLeaf()) root.keptPoints.assign(root.points.begin(), root.points.end());
        root.points = root.keptPoints;
        work.chunk.pointBytes.clear();
        return averageUpwards(root, input_, workspace_, file_ != nullptr);
    }

    Expected<void> store(LeafBlocks& blocks) {
        if (!file_) return {};
        BuildNode& leaf = *blocks.leaf;
        auto place = file_->append(blocks.samples);
        if (!place) return passOn(place);
        leaf.stored.samples = *place;
        auto beside = appendBlocks(*file_, blocks.beside);
        if (!beside) return passOn(beside);
        leaf.beside = *beside;
        giveBack(leaf.content.samples);
        giveBack(leaf.content.densities);
        giveBack(leaf.content.beside);
        return storeColumns(blocks);
    }

    Expected<void> storeColumns(LeafBlocks& blocks) {
        if (!file_) return {};
        BuildNode& leaf = *blocks.leaf;
        leaf.columns.reserve(leaf.columns.size() + blocks.columns.size());
        for (const auto& block : blocks.columns) {
            auto column = file_->append(block);
            if (!column) return passOn(column);
            leaf.columns.push_back(*column);
        }
        for (const auto& block : blocks.positions) {
            auto axis = file_->append(block);
            if (!axis) return passOn(axis);
            leaf.positions.push_back(*axis);
        }
        return {};
    }

    const OctreeInput& input_;
    Workspace& workspace_;
    BlockSink* const file_;
    const SidesOfPatches& decide_;
    ProgressMeter& progress_;
    const std::stop_token& stop_;
    std::atomic<bool> failed_{false};
    std::vector<Chunk> chunks_;
    std::atomic<std::uint64_t> points_{0}, surePoints_{0};

    /// Chunks that wait for their sides, and what those are decided by.
    struct HeldChunk {
        ChunkSides sides;
        std::uint32_t firstPatch = 0;
        std::size_t leaves = 0;
    };
    std::vector<HeldChunk> held_;
    std::vector<Facet> facets_;
    std::vector<PatchCount> patches_;
    std::vector<Border> borders_;
    Sides sides_;
};

}  // namespace

std::uint64_t bytesOfNode(const OctreeInput& input) {
    return nodeBytes + planesOf(input) * columnBytes;
}

Expected<void> averageUpwards(BuildNode& from, const OctreeInput& input, Workspace& workspace, bool inFile) {
    for (BuildNode* node = from.parent; node && ++node->finishedChildren == node->children.size();
         node = node->parent) {
        fillInner(*node, input);
        if (!inFile) continue;
        for (auto& child : node->children) giveBack(child->content.beside);
        if (auto ok = setAside(*node, workspace); !ok) return ok;
    }
    return {};
}

Expected<SureCount> growTree(std::vector<Chunk> chunks, const OctreeInput& input, int lanes,
                             Workspace& workspace, BlockSink* file, const SidesOfPatches& sides,
                             const ProgressSink& progress, const std::stop_token& stop) {
    std::uint64_t points = 0;
    for (const Chunk& chunk : chunks) points += chunk.points;
    ProgressMeter building(progress, "building", points);
    TreeBuilder builder(input, workspace, file, sides, building, stop);
    if (auto ok = builder.run(std::move(chunks), lanes); !ok) return passOn(ok);
    building.finish();
    return builder.sure();
}

Expected<BuiltOctree> buildOctree(BuildNode& root, std::vector<Chunk> chunks, const OctreeInput& input,
                                  int lanes, Workspace& workspace, BlockSink* file,
                                  const ProgressSink& progress, const std::stop_token& stop) {
    const auto sides = [&](const Expected<void>& grown, std::vector<Facet>& facets,
                           std::span<const PatchCount> patches,
                           std::span<const Border> borders) -> Expected<Sides> {
        if (!grown) return passOn(grown);
        return decideSides(facets, patches, borders, input.upIsZ);
    };
    const auto sure = growTree(std::move(chunks), input, lanes, workspace, file, sides, progress, stop);
    if (!sure) return passOn(sure);
    auto built = finishTree(root, input, file, progress, stop);
    if (built) built->sure = sure->share();
    return built;
}

}  // namespace scancast
