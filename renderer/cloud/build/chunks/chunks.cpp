#include "renderer/cloud/build/chunks/chunks.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>

namespace scancast {

namespace {

/// More points than this at exactly one place are no scan.
constexpr std::uint64_t mostAtOnePlace = std::uint64_t(1) << 24;

/// A cloud that is one chunk needs no counting.
Expected<std::vector<Chunk>> takeWhole(PointPortions& portions, std::uint64_t points, BuildNode& root,
                                       const ChunkOptions& options, Workspace& workspace) {
    Chunk chunk;
    chunk.root = &root;
    chunk.points = points;
    auto pointBytes = workspace.allocate(points * sizeof(BuildPoint));
    if (!pointBytes) return passOn(pointBytes);
    auto rowBytes = workspace.allocate(points * options.rowBytes);
    if (!rowBytes) return passOn(rowBytes);
    PointPortions::Portion portion;
    std::uint64_t at = 0;
    for (std::size_t i = 0; i < portions.size(); ++i) {
        auto done = portions.read(i, portion);
        portions.release(i);
        if (done) done = pointBytes->write(at * sizeof(BuildPoint), std::as_bytes(std::span(portion.points)));
        if (done) done = rowBytes->write(at * options.rowBytes, portion.rows);
        if (!done) return passOn(done);
        at += portion.points.size();
    }
    chunk.pointBytes = std::move(*pointBytes);
    chunk.rowBytes = std::move(*rowBytes);
    std::vector<Chunk> one;
    one.push_back(std::move(chunk));
    return one;
}

/// A chunk that is to be divided again.
class ChunkPortions final : public PointPortions {
  public:
    ChunkPortions(const Chunk& chunk, std::size_t rowBytes) : chunk_(chunk), rowBytes_(rowBytes) {}
    std::size_t size() const override { return std::size_t((chunk_.points + each - 1) / each); }
    Expected<void> read(std::size_t index, Portion& into) const override {
        const std::uint64_t first = index * each, n = std::min(each, chunk_.points - first);
        into.points.resize(n);
        into.rows.resize(n * rowBytes_);
        if (auto done = chunk_.pointBytes.read(first * sizeof(BuildPoint),
                                               std::as_writable_bytes(std::span(into.points)));
            !done)
            return done;
        return chunk_.rowBytes.read(first * rowBytes_, into.rows);
    }
    void release(std::size_t) override {}

  private:
    static constexpr std::uint64_t each = PointSource::batchPoints;
    const Chunk& chunk_;
    const std::size_t rowBytes_;
};

Expected<GridBox> boxOf(const PointPortions& portions) {
    GridBox box;
    PointPortions::Portion portion;
    for (std::size_t i = 0; i < portions.size(); ++i) {
        if (auto ok = portions.read(i, portion); !ok) return passOn(ok);
        for (const BuildPoint& p : portion.points) box.add(p.position());
    }
    return box;
}

void growBelow(const LayoutNode& from, BuildNode& to, std::vector<BuildNode*>& places) {
    if (from.children.empty()) places.push_back(&to);
    for (const LayoutNode& child : from.children) {
        BuildNode& node = *to.children.emplace_back(std::make_unique<BuildNode>());
        node.level = to.level + 1;
        node.parent = &to;
        growBelow(child, node, places);
    }
}

}  // namespace

std::vector<BuildNode*> growTop(const LayoutNode& layout, BuildNode& root) {
    std::vector<BuildNode*> places;
    growBelow(layout, root, places);
    return places;
}

Expected<std::vector<Chunk>> divideCrowds(std::vector<Chunk> chunks, std::uint64_t most, const Grid& grid,
                                          const ChunkOptions& options, Workspace& workspace,
                                          ProgressMeter& progress, const std::stop_token& stop) {
    std::vector<Chunk> fitting;
    for (Chunk& chunk : chunks) {
        if (chunk.points <= most) {
            fitting.push_back(std::move(chunk));
            continue;
        }
        ChunkPortions own(chunk, options.rowBytes);
        const auto ownBox = boxOf(own);
        if (!ownBox) return passOn(ownBox);
        if (ownBox->isPoint() && chunk.points > mostAtOnePlace)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("{} points lie at exactly one place; that is no scan.", chunk.points));
        auto finer =
            divide(own, chunk.points, *ownBox, *chunk.root, grid, options, workspace, progress, stop);
        if (!finer) return finer;
        std::move(finer->begin(), finer->end(), std::back_inserter(fitting));
    }
    return fitting;
}

Expected<std::vector<Chunk>> divide(PointPortions& portions, std::uint64_t points, const GridBox& box,
                                    BuildNode& root, const Grid& grid, const ChunkOptions& options,
                                    Workspace& workspace, ProgressMeter& progress,
                                    const std::stop_token& stop) {
    if (points <= options.chunkPoints) return takeWhole(portions, points, root, options, workspace);
    auto counted = countPoints(portions, box, stop);
    if (!counted) return passOn(counted);
    const std::uint64_t most = mostChunkPoints(box, points, options);
    const ChunkLayout layout = layOutChunks(counted->frame(), counted->cells(), grid, most, options.halo);
    const std::vector<BuildNode*> places = growTop(layout.root, root);
    ChunkFiller filler(options.rowBytes);
    if (auto ok = filler.begin(layout, 0, layout.chunks.size(), workspace); !ok) return passOn(ok);
    if (auto ok =
            sortIntoChunks(portions, 0, portions.size(), layout, options.rowBytes, filler, progress, stop);
        !ok)
        return passOn(ok);
    auto chunks = filler.finish();
    if (!chunks) return chunks;
    for (std::size_t i = 0; i < chunks->size(); ++i) (*chunks)[i].root = places[i];
    return divideCrowds(std::move(*chunks), most, grid, options, workspace, progress, stop);
}

}  // namespace scancast
