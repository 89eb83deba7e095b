#include "renderer/cloud/build/chunks/chunk_sorting.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

namespace scancast {

namespace {

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
    Sorter(const ChunkLayout& layout, ChunkTaker& taker, std::size_t rowBytes)
        : layout_(layout), taker_(taker), rowBytes_(rowBytes) {}

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
        auto done = giveRuns(own_, rows_, false);
        if (done) done = giveRuns(halo_, {}, true);
        own_.clear();
        halo_.clear();
        rows_.clear();
        return done;
    }

  private:
    /// Fills order_ with the numbers of what goes to the first chunk, then to the second …; counts instead of
    /// comparing.
    void sortByChunk(std::span<const std::uint32_t> chunks) {
        next_.assign(layout_.chunks.size() + 1, 0);
        for (const std::uint32_t c : chunks) ++next_[c + 1];
        std::partial_sum(next_.begin(), next_.end(), next_.begin());
        order_.resize(chunks.size());
        for (std::uint32_t i = 0; i < chunks.size(); ++i) order_[next_[chunks[i]]++] = i;
    }

    /// One run for each chunk.
    Expected<void> giveRuns(const Addressed& from, std::span<const std::byte> rows, bool halo) {
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
            if (auto ok = taker_.take({.chunk = chunk, .halo = halo, .points = run_, .rows = rowRun_}); !ok)
                return ok;
        }
        return {};
    }

    const ChunkLayout& layout_;
    ChunkTaker& taker_;
    const std::size_t rowBytes_;
    Addressed own_, halo_;
    std::vector<std::byte> rows_, rowRun_;
    std::vector<std::uint32_t> order_, next_;
    std::vector<BuildPoint> run_;
};

}  // namespace

Expected<CountingGrid> countPoints(const PointPortions& portions, const GridBox& box,
                                   const std::stop_token& stop) {
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

ChunkFiller::ChunkFiller(std::size_t rowBytes) : rowBytes_(rowBytes) {}

Expected<void> ChunkFiller::begin(const ChunkLayout& layout, std::size_t first, std::size_t last,
                                  Workspace& workspace) {
    first_ = first;
    for (const ChunkLayout::Chunk& place : std::span(layout.chunks).subspan(first, last - first)) {
        Chunk& chunk = fillings_.emplace_back(std::make_unique<Filling>())->chunk;
        chunk.points = place.points;
        chunk.halo = place.halo;
        for (const auto& [buffer, bytes] : {std::pair(&chunk.pointBytes, place.points * sizeof(BuildPoint)),
                                            std::pair(&chunk.haloBytes, place.halo * sizeof(BuildPoint)),
                                            std::pair(&chunk.rowBytes, place.points * rowBytes_)}) {
            auto room = workspace.allocate(bytes);
            if (!room) return passOn(room);
            *buffer = std::move(*room);
        }
    }
    return {};
}

Expected<void> ChunkFiller::take(const ChunkRun& run) {
    Filling& to = *fillings_[run.chunk - first_];
    const std::uint64_t at = (run.halo ? to.nextHalo : to.nextPoint).fetch_add(run.points.size());
    if (at + run.points.size() > (run.halo ? to.chunk.halo : to.chunk.points))
        return fail(ErrorCode::Internal, "A part of the cloud has more points than were counted.");
    Workspace::Buffer& bytes = run.halo ? to.chunk.haloBytes : to.chunk.pointBytes;
    auto done = bytes.write(at * sizeof(BuildPoint), std::as_bytes(run.points));
    if (done && !run.rows.empty()) done = to.chunk.rowBytes.write(at * rowBytes_, run.rows);
    return done;
}

Expected<std::vector<Chunk>> ChunkFiller::finish() {
    std::vector<Chunk> chunks;
    for (const auto& filling : fillings_) {
        if (filling->nextPoint != filling->chunk.points || filling->nextHalo != filling->chunk.halo)
            return fail(ErrorCode::Internal, "A part of the cloud has fewer points than were counted.");
        chunks.push_back(std::move(filling->chunk));
    }
    return chunks;
}

Expected<void> sortIntoChunks(PointPortions& portions, std::size_t begin, std::size_t end,
                              const ChunkLayout& layout, std::size_t rowBytes, ChunkTaker& taker,
                              ProgressMeter& progress, const std::stop_token& stop, std::size_t together) {
    FirstError error;
    const std::size_t groups = (end - begin + together - 1) / together;
    tbb::enumerable_thread_specific<Sorter> sorters([&] { return Sorter(layout, taker, rowBytes); });
    tbb::parallel_for(std::size_t(0), groups, [&](std::size_t g) {
        if (error.failed() || stop.stop_requested()) return;
        thread_local PointPortions::Portion portion;
        Sorter& sorter = sorters.local();
        const std::size_t first = begin + g * together;
        for (std::size_t i = first; i < std::min(first + together, end); ++i) {
            if (auto read = portions.read(i, portion); !read) return error.set(read.error());
            portions.release(i);
            sorter.add(portion);
            progress.add(portion.points.size());
        }
        if (auto flushed = sorter.flush(); !flushed) error.set(flushed.error());
    });
    if (auto ok = error.result(); !ok) return passOn(ok);
    if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
    return {};
}

}  // namespace scancast
