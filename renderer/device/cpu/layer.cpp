#include "renderer/device/cpu/layer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/cpu/grown.hpp"

namespace scancast::cpu {
namespace {

/// Samples between two looks at the stop token: under a millisecond.
constexpr std::uint32_t sliceSamples = 16384;
/// More tiles than threads, so that all threads end at about the same time.
constexpr int tilesPerThread = 3;
/// Of all frames that are drawn at once: up to 16 bytes each, colours with and without margin, depths and normals. Four frames of 1920 x 1080.
constexpr std::int64_t mostPixelsAtOnce = std::int64_t{1} << 23;
/// Blocks of keys that the passes of one frame need at most: nearest, silhouette, cell.
constexpr int keyBlocks = 3;
/// Of a look-up from ordinals to runs: how many ordinals share a place to begin.
constexpr int ordinalShift = 10;

double largestShift(std::span<const glm::dvec2> jitter) {
    double largest = 0;
    for (const glm::dvec2& j : jitter) largest = std::max({largest, std::abs(j.x), std::abs(j.y)});
    return largest;
}

/// A tile's geometry, without memory.
KeyTile emptyTile(const Rect& area) {
    KeyTile tile;
    tile.x = area.x0;
    tile.y = area.y0;
    tile.width = area.width();
    tile.height = area.height();
    tile.stride = (area.width() + 2 * guard + 7) / 8 * 8;
    tile.planeSize = std::int64_t{tile.stride} * (area.height() + 2 * guard);
    return tile;
}

/// The tile with the block-th of the memory's key blocks.
KeyTile withKeys(KeyTile tile, TileMemory& memory, int block) {
    Key* const keys = memory.keys.data() + block * (tile.planeSize + unusedKeys);
    tile.keys = keys + guard * tile.stride + guard;
    tile.unused = keys + tile.planeSize;
    return tile;
}

/// Moves the sums to where they have 64 bits, and starts anew.
void emptySums(const KeyTile& tile, int planes, TileMemory& memory) {
    const auto size = static_cast<std::size_t>(planes * tile.planeSize);
    if (memory.wide.empty()) memory.wide.assign(size, 0);
    for (std::size_t i = 0; i < size; ++i) {
        const std::int32_t narrow = memory.sums[i];
        const bool isSigned = i >= static_cast<std::size_t>(colorPlanes * tile.planeSize);
        memory.wide[i] += isSigned ? std::int64_t{narrow} : std::int64_t{static_cast<std::uint32_t>(narrow)};
        memory.sums[i] = 0;
    }
}

Owners movedBy(const Owners& first, std::ptrdiff_t right, std::ptrdiff_t down) {
    Owners o = first;
    const std::ptrdiff_t at = down * o.stride + right;
    o.places += at;
    o.halves += at;
    o.orders += at;
    o.colors += at;
    return o;
}

/// Of a tile's pixel (0, 0); null: nothing was moved there.
const std::int64_t* wideSums(const KeyTile& tile, const TileMemory& memory) {
    return memory.wide.empty() ? nullptr : memory.wide.data() + guard * tile.stride + guard;
}

/// Between them runs without samples: others' ordinals are looked up, too.
std::vector<SplatRun> withGaps(const std::vector<SplatRun>& byOrdinal, std::uint64_t end) {
    std::vector<SplatRun> all;
    std::uint64_t next = 0;
    const auto gapUntil = [&](std::uint64_t ordinal) {
        if (next < ordinal) all.emplace_back().firstOrdinal = static_cast<std::uint32_t>(next);
    };
    for (const SplatRun& run : byOrdinal) {
        gapUntil(run.firstOrdinal);
        all.push_back(run);
        next = std::uint64_t{run.firstOrdinal} + run.count;
    }
    gapUntil(end);
    return all;
}

}  // namespace

Owners OwnerMemory::around(const Rect& area) {
    // Kernels read whole registers, beyond a row's end, too.
    constexpr int widest = 16;
    const int stride = area.width() + 2, rows = area.height() + 2;
    const std::size_t size = static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows) + widest;
    const Owners first{grown(places, size), grown(halves, size), grown(orders, size), grown(colors, size),
                       stride};
    constexpr float background = std::numeric_limits<float>::infinity();
    std::fill_n(first.orders, stride, background);
    std::fill_n(first.orders + std::ptrdiff_t{rows - 1} * stride, stride + widest, background);
    for (int y = 1; y < rows - 1; ++y) {
        float* const row = first.orders + std::ptrdiff_t{y} * stride;
        row[0] = row[stride - 1] = background;
    }
    return movedBy(first, 1, 1);
}

Layer::Layer(const Drawing& drawing, const CutView& view, const LayerView& layerView,
             const FramePasses& passes, const Kernels& kernels, const Workers& workers,
             TileMemories& memories, const Rect& area, Together* together)
    : layerView_(layerView),
      passes_(passes),
      kernels_(kernels),
      workers_(workers),
      memories_(memories),
      area_(area),
      together_(together),
      tables_(colorTables(drawing.color, view.filter)),
      splats_(splatPasses(passes, layerView, drawing.color)) {
    for (SplatPass& pass : splats_) {
        if (pass.ownRadii) pass.radii = surfelRadii().data();
        pass.curvatures = curvatureSteps().data();
        pass.ramp = tables_.ramp.data();
        pass.factors = tables_.factors.data();
        pass.normals = tables_.normals.data();
        if (tables_.byClass) pass.classes = tables_.classes.data();
        pass.outliers = view.filter.outliers;
    }
    background_ = backgroundRows(drawing.background, area_.y0 - layerView.pad, area_.height(),
                                 layerView.viewpoint->height);
    prepareRuns(drawing, view);
    workers_.pauseIfDue();
    if (passes.bySample()) listSamples(view.cut);
    workers_.pauseIfDue();
    if (!workers_.stopped()) tiles_ = cutIntoTiles(area_, runs_, workers_.threads() * tilesPerThread);
}

void Layer::prepareRuns(const Drawing& drawing, const CutView& view) {
    const Cut& cut = view.cut;
    std::vector<std::optional<PreparedRun>> prepared(cut.runs.size());
    const double shift = largestShift(drawing.jitter);
    constexpr std::size_t batch = 64;
    workers_.inParallel(static_cast<int>((cut.runs.size() + batch - 1) / batch), [&](int b) {
        const std::size_t first = static_cast<std::size_t>(b) * batch;
        for (std::size_t i = first; i < std::min(cut.runs.size(), first + batch); ++i) {
            prepared[i] =
                prepareRun(cut.runs[i], layerView_, splats_, drawing.color, view.filter, area_, shift);
        }
    });
    for (const auto& run : prepared) {
        if (run) runs_.push_back(*run);
    }
    // Front to back: what is hidden is then found to be so before it is drawn.
    std::ranges::stable_sort(runs_, {}, &PreparedRun::front);
}

void Layer::listSamples(const Cut& cut) {
    // Who shows in a pixel is asked of sprites, which have one splat pass.
    for (const PreparedRun& prepared : runs_)
        byOrdinal_.emplace_back(prepared.run).sizeFactor = prepared.sizes.front().sizeFactor;
    std::ranges::sort(byOrdinal_, {}, &SplatRun::firstOrdinal);
    std::uint64_t end =
        byOrdinal_.empty() ? 0 : std::uint64_t{byOrdinal_.back().firstOrdinal} + byOrdinal_.back().count;
    if (together_ != nullptr) {
        end = std::max(end, cut.samples);
        byOrdinal_ = withGaps(byOrdinal_, end);
    }
    runAt_.assign((end >> ordinalShift) + 1, 0);
    std::uint32_t run = 0;
    for (std::size_t i = 0; i < runAt_.size(); ++i) {
        while (run + 1 < byOrdinal_.size() && byOrdinal_[run + 1].firstOrdinal <= i << ordinalShift) ++run;
        runAt_[i] = run;
    }
    samples_ = {byOrdinal_.data(), static_cast<std::uint32_t>(byOrdinal_.size()), runAt_.data(),
                ordinalShift};
}

/// From the sample that it has come to; false: the slice is over before its last one.
bool Layer::splatRun(TileDrawing& at, const PreparedRun& prepared, SplatRun slice, const SplatPass& pass) {
    while (at.sample < prepared.run.count) {
        if (workers_.stopped() || workers_.sliceIsOver()) return false;
        slice.samples = prepared.run.samples + at.sample;
        if (prepared.run.beside != nullptr) slice.beside = prepared.run.beside + at.sample;
        if (prepared.run.limits != nullptr) slice.limits = prepared.run.limits + at.sample / limitsStep;
        slice.count = std::min(sliceSamples, prepared.run.count - at.sample);
        slice.firstOrdinal = prepared.run.firstOrdinal + at.sample;
        std::uint32_t done = slice.count;
        if (at.frameCount > 1)
            kernels_.splatFrames(pass, slice, at.frames.data(), at.frameCount);
        else
            done = kernels_.splat(pass, slice, at.target);
        if (pass.reduction == Reduction::Sum && done < slice.count)
            emptySums(at.target, colorPlanes + (pass.sumNormals ? normalPlanes : 0), *at.memory);
        at.sample += done;
    }
    at.sample = 0;
    return true;
}

/// Whether everything in a part of the tile lies in front of that order.
bool Layer::hidesRun(const TileDrawing& at, const Rect& part, std::int32_t frontOrder) const {
    const auto hides = [&](KeyTile tile) {
        if (tile.visible != nullptr) tile.keys = const_cast<Key*>(tile.visible);
        return kernels_.hidden(tile, part.x0 - tile.x, part.y0 - tile.y, part.x1 - tile.x, part.y1 - tile.y,
                               frontOrder);
    };
    if (at.frameCount == 1) return hides(at.target);
    return std::all_of(at.frames.begin(), at.frames.begin() + at.frameCount,
                       [&](const FrameTile& frame) { return hides(frame.tile); });
}

bool Layer::drawRuns(TileDrawing& at, const SplatPass& pass) {
    for (; at.run < at.tile->runs.size(); ++at.run) {
        const PreparedRun& prepared = runs_[at.tile->runs[at.run]];
        const PassSize& size = prepared.sizes[at.pass];
        const Rect part = prepared.bounds.intersect(at.tile->area);
        if (at.sample == 0 && hidesRun(at, part, size.frontOrder)) continue;
        SplatRun slice = prepared.run;
        slice.sizeFactor = size.sizeFactor;
        slice.largestPx = size.largestPx;
        slice.crossesTile =
            part.width() < prepared.bounds.width() || part.height() < prepared.bounds.height();
        if (!splatRun(at, prepared, slice, pass)) return false;
    }
    at.run = 0;
    return true;
}

/// `frames`: which are drawn at once, if there are several.
void Layer::begin(TileDrawing& at, const Tile& tile, std::span<const FrameDrawing> frames) {
    TileMemory* const memory = at.memory;
    at = {};
    at.memory = memory;
    at.tile = &tile;
    at.empty = emptyTile(tile.area);
    at.frameCount = std::max(1, static_cast<int>(frames.size()));
    grown(memory->keys, static_cast<std::size_t>(at.empty.planeSize + unusedKeys) *
                            static_cast<std::size_t>(std::max(keyBlocks, at.frameCount)));
    memory->wide.clear();
    at.nearest = at.colors = withKeys(at.empty, *memory, 0);
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const SplatPass& pass = frames[f].passes.front();
        at.frames[f] = {pass.centerX, pass.centerY, withKeys(at.empty, *memory, static_cast<int>(f))};
    }
}

void Layer::beginPass(TileDrawing& at, const SplatPass& pass) {
    TileMemory& memory = *at.memory;
    at.target = at.nearest;
    at.target.silhouette = at.silhouette;
    switch (pass.reduction) {
        case Reduction::Nearest:
            if (pass.silhouette) {
                at.target = withKeys(at.empty, memory, 1);
                at.silhouette = at.target.keys;
            }
            kernels_.clear(at.target);
            for (int f = 1; f < at.frameCount; ++f) kernels_.clear(at.frames[std::size_t(f)].tile);
            break;
        case Reduction::Sum: {
            const int count = colorPlanes + (pass.sumNormals ? normalPlanes : 0);
            memory.sums.assign(static_cast<std::size_t>(count * at.empty.planeSize), 0);
            at.target.visible = at.nearest.keys;
            at.target.surfaces = at.colors.keys;
            at.target.sums = memory.sums.data() + guard * at.empty.stride + guard;
            at.colors.sums = at.target.sums;
            break;
        }
        case Reduction::Cell:
            at.target = withKeys(at.nearest, memory, 2);
            at.target.visible = at.nearest.keys;
            at.target.silhouette = at.silhouette;
            at.colors.keys = at.target.keys;
            at.colors.visible = at.nearest.keys;
            kernels_.clear(at.target);
            break;
    }
    at.begun = true;
}

/// False: the slice is over, and the tile is not done.
bool Layer::goOn(TileDrawing& at, std::span<const FrameDrawing> frames) {
    const FrameDrawing& frame = frames.front();
    auto start = Workers::Clock::now();
    const auto spend = [&](std::size_t on) {
        const auto now = Workers::Clock::now();
        spent_[on] += std::chrono::duration_cast<std::chrono::nanoseconds>(now - start).count();
        start = now;
    };
    for (; at.pass < frame.passes.size(); ++at.pass) {
        if (!at.begun) beginPass(at, frame.passes[at.pass]);
        const bool done = drawRuns(at, frame.passes[at.pass]);
        spend(at.pass);
        if (!done) return false;
        at.begun = false;
        if (workers_.sliceIsOver() && at.pass + 1 < frame.passes.size()) {
            ++at.pass;
            return false;
        }
    }
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const FrameDrawing& one = frames[f];
        const KeyTile& nearest = f == 0 ? at.nearest : at.frames[f].tile;
        resolveTile(nearest, f == 0 ? at.colors : nearest, one.passes.back(),
                    wideSums(at.nearest, *at.memory), one.planes, one.owners);
    }
    spend(frame.passes.size());
    at.tile = nullptr;
    return true;
}

void Layer::resolveTile(const KeyTile& nearest, const KeyTile& colors, const SplatPass& pass,
                        const std::int64_t* wide, const Planes& planes, const Owners& owners) {
    PixelTile pixels;
    pixels.stride = planes.area.width();
    const std::ptrdiff_t offset = planes.at(nearest.x, nearest.y);
    pixels.rgba = planes.rgba + offset;
    pixels.depth = planes.depth != nullptr ? planes.depth + offset : nullptr;
    const bool normals = passes_.resolve.normals && planes.normals != nullptr;
    pixels.normals = normals ? planes.normals + offset : nullptr;
    pixels.background = background_.data() + (nearest.y - area_.y0);
    if (owners.places != nullptr)
        pixels.owners = movedBy(owners, nearest.x - planes.area.x0, nearest.y - planes.area.y0);
    if (passes_.bySample()) {
        kernels_.resolveSamples(pass, samples_, colors, pixels);
    } else {
        if (normals) {
            for (int y = 0; y < nearest.height; ++y)
                std::fill_n(pixels.normals + std::ptrdiff_t{y} * pixels.stride, nearest.width, 0u);
        }
        kernels_.resolve(nearest, pixels);
    }
    if (passes_.resolve.sums) kernels_.resolveSums(colors, wide, pixels);
}

void Layer::smooth(const SplatPass& pass, const Planes& planes, const Owners& owners) const {
    Smoothing whole;
    whole.perspective = pass.perspective;
    whole.square = pass.shape == SplatShape::ParaboloidSquare;
    whole.bulge = pass.gain * pass.radiusPerPixel;
    whole.stride = whole.width = planes.area.width();
    workers_.overRows(planes.area.height(), [&](int y0, int y1) {
        Smoothing rows = whole;
        rows.owners = movedBy(owners, 0, y0);
        rows.rgba = planes.rgba + static_cast<std::ptrdiff_t>(y0) * whole.stride;
        rows.height = y1 - y0;
        kernels_.smooth(rows);
    });
}

/// Sprites, whose samples are drawn in one pass.
int Layer::framesAtOnce(std::int64_t pixels) const {
    const bool sprites = splats_.size() == 1 && !ofSurfels(splats_.front());
    if (together_ != nullptr || !sprites || passes_.resolve.smooth) return 1;
    return static_cast<int>(std::clamp(mostPixelsAtOnce / std::max<std::int64_t>(1, pixels), std::int64_t{1},
                                       std::int64_t{mostFrames}));
}

void Layer::draw(std::span<const glm::dvec2> jitters, std::span<const Planes> planes, FrameStats& stats) {
    std::vector<FrameDrawing> frames(jitters.size());
    for (std::size_t f = 0; f < frames.size(); ++f) {
        FrameDrawing& frame = frames[f];
        frame.passes = splats_;
        for (SplatPass& pass : frame.passes) pass = jittered(pass, layerView_, jitters[f]);
        frame.planes = planes[f];
        if (passes_.resolve.smooth && frame.planes.owners != nullptr)
            frame.owners = frame.planes.owners->around(frame.planes.area);
    }
    for (auto& time : spent_) time = 0;
    if (together_ != nullptr)
        drawTogether(frames.front(), stats);
    else
        drawAlone(frames, stats);
    const FrameDrawing& frame = frames.front();
    if (frame.owners.places == nullptr || workers_.stopped()) return;
    const auto smoothing = workers_.now();
    const Planes seen = together_ != nullptr ? own(frame.planes) : frame.planes;
    smooth(frame.passes.front(), seen, movedBy(frame.owners, 0, seen.area.y0 - frame.planes.area.y0));
    stats.add("smooth", workers_.millisecondsSince(smoothing));
}

void Layer::drawAlone(std::span<const FrameDrawing> frames, FrameStats& stats) {
    const std::vector<SplatPass>& passes = frames.front().passes;
    const auto start = workers_.now();
    std::vector<TileDrawing> drawings(std::min(tiles_.size(), memories_.size()));
    for (std::size_t i = 0; i < drawings.size(); ++i) drawings[i].memory = memories_[i].get();
    std::atomic<std::size_t> next{0};
    workers_.inSlices(static_cast<int>(drawings.size()), [&](int i) {
        TileDrawing& at = drawings[static_cast<std::size_t>(i)];
        while (!workers_.stopped()) {
            if (at.tile == nullptr) {
                const std::size_t tile = next++;
                if (tile >= tiles_.size()) return true;
                begin(at, tiles_[tile], frames.size() > 1 ? frames : std::span<const FrameDrawing>{});
            }
            if (!goOn(at, frames)) return false;
            if (workers_.sliceIsOver()) return next >= tiles_.size();
        }
        return true;
    });
    // All passes run side by side: the time that passed is shared out by what the threads spent on each.
    const double passed = workers_.millisecondsSince(start);
    std::int64_t all = 0;
    for (const auto& time : spent_) all += time;
    for (std::size_t i = 0; i <= passes.size(); ++i) {
        stats.add(i < passes.size() ? nameOf(passes[i]) : "resolve",
                  passed * double(spent_[i]) / double(std::max<std::int64_t>(1, all)));
    }
}

}  // namespace scancast::cpu
