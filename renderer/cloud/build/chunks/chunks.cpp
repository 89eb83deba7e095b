#include "renderer/cloud/build/chunks/chunks.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <optional>

namespace scancast {

namespace {

/// More points than this at exactly one place are no scan.
constexpr std::uint64_t mostAtOnePlace = std::uint64_t(1) << 24;
/// Portions sorted together, so that what goes to one chunk's place on the disk is worth a write.
constexpr std::size_t portionsAtOnce = 8;

/// The first error of many threads.
class FirstError {
  public:
    void set(Error error) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::move(error);
        failed_ = true;
    }
    bool failed() const { return failed_; }
    Expected<void> result() {
        if (error_) return tl::unexpected(*error_);
        return {};
    }

  private:
    std::mutex mutex_;
    std::optional<Error> error_;
    std::atomic<bool> failed_{false};
};

Expected<CountingGrid> count(const PointPortions& portions, const GridBox& box, const std::stop_token& stop) {
    tbb::enumerable_thread_specific<CountingGrid> counts([&] { return CountingGrid(box); });
    FirstError error;
    tbb::parallel_for(std::size_t(0), portions.size(), [&](std::size_t i) {
        if (error.failed() || stop.stop_requested()) return;
        thread_local PointPortions::Portion portion;
        if (auto read = portions.read(i, portion); !read) return error.set(read.error());
        counts.local().add(portion.points);
    });
    if (auto ok = error.result(); !ok) return passOn(ok);
    if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
    CountingGrid all(box);
    for (const CountingGrid& one : counts) all.join(one);
    return all;
}

/// A chunk's places are handed out in pieces to the threads that fill it.
struct Filling {
    Chunk chunk;
    std::atomic<std::uint64_t> nextPoint{0}, nextHalo{0};
};

/// Points and the chunks that they go to, as they come.
struct Addressed {
    std::vector<BuildPoint> points;
    std::vector<std::uint32_t> chunks;

    void add(const BuildPoint& p, std::uint32_t chunk) {
        points.push_back(p);
        chunks.push_back(chunk);
    }
    void clear() {
        points.clear();
        chunks.clear();
    }
};

/// What one thread holds back of several portions, to write it chunk by chunk.
class Sorter {
  public:
    Sorter(const ChunkLayout& layout, std::span<const std::unique_ptr<Filling>> fillings,
           std::size_t rowBytes)
        : layout_(layout), fillings_(fillings), rowBytes_(rowBytes) {}

    void add(const PointPortions::Portion& portion) {
        const ChunkLayout::Destination* to = nullptr;
        CellKey last = ~CellKey(0);
        for (std::size_t i = 0; i < portion.points.size(); ++i) {
            const BuildPoint& p = portion.points[i];
            if (i + cellsExpected < portion.points.size())
                layout_.index.expect(layout_.frame.key(portion.points[i + cellsExpected].position()));
            const CellKey key = layout_.frame.key(p.position());
            if (key != last) to = &layout_.destination(key);
            last = key;
            own_.add(p, to->chunk);
            for (std::uint32_t h = to->firstHalo; h < to->firstHalo + to->halos; ++h)
                halo_.add(p, layout_.haloChunks[h]);
        }
        rows_.insert(rows_.end(), portion.rows.begin(), portion.rows.end());
    }

    Expected<void> flush() {
        auto done = writeRuns(own_, rows_, &Chunk::pointBytes, &Filling::nextPoint);
        if (done) done = writeRuns(halo_, {}, &Chunk::haloBytes, &Filling::nextHalo);
        own_.clear();
        halo_.clear();
        rows_.clear();
        return done;
    }

  private:
    /// Fills order_ with the numbers of what goes to the first chunk, then to the second …; counts instead of
    /// comparing.
    void sortByChunk(std::span<const std::uint32_t> chunks) {
        next_.assign(fillings_.size() + 1, 0);
        for (const std::uint32_t c : chunks) ++next_[c + 1];
        std::partial_sum(next_.begin(), next_.end(), next_.begin());
        order_.resize(chunks.size());
        for (std::uint32_t i = 0; i < chunks.size(); ++i) order_[next_[chunks[i]]++] = i;
    }

    /// One write for each chunk; places are taken from the chunk's counter.
    Expected<void> writeRuns(const Addressed& from, std::span<const std::byte> rows,
                             Workspace::Buffer Chunk::*points, std::atomic<std::uint64_t> Filling::*next) {
        sortByChunk(from.chunks);
        for (std::size_t first = 0, last = 0; first < order_.size(); first = last) {
            const std::uint32_t chunk = from.chunks[order_[first]];
            run_.clear();
            rowRun_.clear();
            for (; last < order_.size() && from.chunks[order_[last]] == chunk; ++last) {
                run_.push_back(from.points[order_[last]]);
                if (rows.empty()) continue;
                const auto row = rows.subspan(order_[last] * rowBytes_, rowBytes_);
                rowRun_.insert(rowRun_.end(), row.begin(), row.end());
            }
            Filling& to = *fillings_[chunk];
            const std::uint64_t at = (to.*next).fetch_add(run_.size());
            auto done = (to.chunk.*points).write(at * sizeof(BuildPoint), std::as_bytes(std::span(run_)));
            if (done && !rows.empty()) done = to.chunk.rowBytes.write(at * rowBytes_, rowRun_);
            if (!done) return done;
        }
        return {};
    }

    const ChunkLayout& layout_;
    std::span<const std::unique_ptr<Filling>> fillings_;
    const std::size_t rowBytes_;
    Addressed own_, halo_;
    std::vector<std::byte> rows_, rowRun_;
    std::vector<std::uint32_t> order_, next_;
    std::vector<BuildPoint> run_;
};

Expected<std::vector<Chunk>> distribute(PointPortions& portions, const ChunkLayout& layout,
                                        const ChunkOptions& options, Workspace& workspace,
                                        ProgressMeter& progress, const std::stop_token& stop) {
    std::vector<std::unique_ptr<Filling>> fillings;
    for (const ChunkLayout::Chunk& place : layout.chunks) {
        Chunk& chunk = fillings.emplace_back(std::make_unique<Filling>())->chunk;
        chunk.points = place.points;
        chunk.halo = place.halo;
        for (const auto& [buffer, bytes] : {std::pair(&chunk.pointBytes, place.points * sizeof(BuildPoint)),
                                            std::pair(&chunk.haloBytes, place.halo * sizeof(BuildPoint)),
                                            std::pair(&chunk.rowBytes, place.points * options.rowBytes)}) {
            auto room = workspace.allocate(bytes);
            if (!room) return passOn(room);
            *buffer = std::move(*room);
        }
    }
    FirstError error;
    const std::size_t groups = (portions.size() + portionsAtOnce - 1) / portionsAtOnce;
    tbb::enumerable_thread_specific<Sorter> sorters(
        [&] { return Sorter(layout, fillings, options.rowBytes); });
    tbb::parallel_for(std::size_t(0), groups, [&](std::size_t g) {
        if (error.failed() || stop.stop_requested()) return;
        thread_local PointPortions::Portion portion;
        Sorter& sorter = sorters.local();
        for (std::size_t i = g * portionsAtOnce; i < std::min((g + 1) * portionsAtOnce, portions.size());
             ++i) {
            if (auto read = portions.read(i, portion); !read) return error.set(read.error());
            portions.release(i);
            sorter.add(portion);
            progress.add(portion.points.size());
        }
        if (auto flushed = sorter.flush(); !flushed) error.set(flushed.error());
    });
    if (auto ok = error.result(); !ok) return passOn(ok);
    if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
    std::vector<Chunk> chunks;
    for (const auto& filling : fillings) chunks.push_back(std::move(filling->chunk));
    return chunks;
}

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

/// Grows tree nodes as laid out and lists the places of the chunks, in order.
void growTop(const LayoutNode& from, BuildNode& to, std::vector<BuildNode*>& places) {
    if (from.children.empty()) places.push_back(&to);
    for (const LayoutNode& child : from.children) {
        BuildNode& node = *to.children.emplace_back(std::make_unique<BuildNode>());
        node.level = to.level + 1;
        node.parent = &to;
        growTop(child, node, places);
    }
}

}  // namespace

Expected<std::vector<Chunk>> divide(PointPortions& portions, std::uint64_t points, const GridBox& box,
                                    BuildNode& root, const Grid& grid, const ChunkOptions& options,
                                    Workspace& workspace, ProgressMeter& progress,
                                    const std::stop_token& stop) {
    if (points <= options.chunkPoints) return takeWhole(portions, points, root, options, workspace);
    auto counted = count(portions, box, stop);
    if (!counted) return passOn(counted);
    const std::uint64_t most = box.isPoint() ? points : options.chunkPoints;
    const ChunkLayout layout = layOutChunks(counted->frame(), counted->cells(), grid, most, options.halo);
    std::vector<BuildNode*> places;
    growTop(layout.root, root, places);
    auto chunks = distribute(portions, layout, options, workspace, progress, stop);
    if (!chunks) return chunks;

    std::vector<Chunk> fitting;
    for (std::size_t i = 0; i < chunks->size(); ++i) {
        Chunk& chunk = (*chunks)[i];
        chunk.root = places[i];
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

}  // namespace scancast
