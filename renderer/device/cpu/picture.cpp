#include "renderer/device/cpu/picture.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace scancast::cpu {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::int64_t nanoseconds(Clock::duration d) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(d).count();
}

/// Samples between two looks at the stop token: under a millisecond.
constexpr std::uint32_t sliceSamples = 16384;
/// More tiles than threads, so that all threads end at about the same time.
constexpr int tilesPerThread = 3;

int reachOf(const std::optional<EyeDomePass>& eyeDome) {
    return eyeDome ? static_cast<int>(std::ceil(std::clamp(eyeDome->radiusPx, 0.0f, 64.0f))) : 0;
}

double largestShift(std::span<const glm::dvec2> jitter) {
    double largest = 0;
    for (const glm::dvec2& j : jitter) largest = std::max({largest, std::abs(j.x), std::abs(j.y)});
    return largest;
}

/// The eight neighbours at the pass's radius, and methods.md §9's shade = exp(-300 · strength · mean
/// response).
void setEyeDome(const EyeDomePass& pass, EyeDome& e) {
    const double radius = std::clamp(pass.radiusPx, 0.0f, 64.0f);
    for (int k = 0; k < 8; ++k) {
        const double angle = k * 0.785398163397448309616;
        e.offsets[k] = static_cast<std::int32_t>(std::lround(radius * std::sin(angle))) * e.logStride +
                       static_cast<std::int32_t>(std::lround(radius * std::cos(angle)));
    }
    constexpr double log2e = 1.44269504088896340736;
    e.factor = static_cast<float>(300.0 * std::clamp(pass.strength, 0.0f, 1000.0f) / 8 * log2e);
}

template <class T>
T* grown(std::vector<T>& buffer, std::size_t size) {
    if (buffer.size() < size) buffer.resize(size);
    return buffer.data();
}

}  // namespace

Expected<PassPlan> planPasses(std::span<const Pass> passes) {
    PassPlan plan;
    const bool known = (passes.size() == 2 || passes.size() == 3) &&
                       std::holds_alternative<NearestPass>(passes[0]) &&
                       std::holds_alternative<ResolvePass>(passes[1]);
    if (!known || (passes.size() == 3 && !std::holds_alternative<EyeDomePass>(passes[2]))) {
        return fail(ErrorCode::Unsupported,
                    "The cpu device draws nearest, resolve and eye-dome passes, in this order; this method "
                    "lists others.");
    }
    plan.nearest = std::get<NearestPass>(passes[0]);
    if (passes.size() == 3) plan.eyeDome = std::get<EyeDomePass>(passes[2]);
    return plan;
}

Picture::Picture(const Drawing& drawing, const PassPlan& plan, const Kernels& kernels, int threads,
                 tbb::task_arena& arena, Buffers& buffers, std::stop_token stop)
    : drawing_(drawing),
      plan_(plan),
      kernels_(kernels),
      threads_(threads),
      arena_(arena),
      buffers_(buffers),
      stop_(std::move(stop)) {
    const Window& w = drawing.window;
    const Viewpoint& viewpoint = *drawing.viewpoint;
    window_ = {w.x, w.y, w.x + w.width, w.y + w.height};
    const int reach = reachOf(plan.eyeDome);
    area_ = Rect{window_.x0 - reach, window_.y0 - reach, window_.x1 + reach, window_.y1 + reach}.intersect(
        {0, 0, viewpoint.width, viewpoint.height});
    pass_ = preparePass(viewpoint, plan.nearest);
    setColors(drawing.color, drawing.filter, buffers.tables, pass_);
    background_ = backgroundRows(drawing.background, area_.y0, area_.height(), viewpoint.height);
}

template <class Work>
void Picture::inParallel(int count, const Work& work) {
    std::atomic<int> next{0};
    const int workers = std::min(threads_, count);
    // Workers take one piece after another, in order: heavy tiles first, and nobody waits for a late starter.
    const auto takeTurns = [&](int) {
        for (int i = next++; i < count && !stop_.stop_requested(); i = next++) work(i);
    };
    if (workers <= 1) return takeTurns(0);
    arena_.execute([&] { tbb::parallel_for(0, workers, takeTurns, tbb::simple_partitioner()); });
}

template <class Work>
void Picture::overRows(int rows, const Work& work) {
    const int band = std::max(8, rows / (threads_ * 4));
    inParallel((rows + band - 1) / band, [&](int i) { work(i * band, std::min(rows, (i + 1) * band)); });
}

void Picture::prepareRuns() {
    const std::span<const CutRun> cut = drawing_.cut->runs;
    std::vector<std::optional<PreparedRun>> prepared(cut.size());
    const double shift = largestShift(drawing_.jitter);
    constexpr std::size_t batch = 64;
    inParallel(static_cast<int>((cut.size() + batch - 1) / batch), [&](int b) {
        const std::size_t first = static_cast<std::size_t>(b) * batch;
        for (std::size_t i = first; i < std::min(cut.size(), first + batch); ++i) {
            prepared[i] = prepareRun(cut[i], *drawing_.viewpoint, plan_.nearest, pass_, drawing_.color,
                                     drawing_.filter, area_, shift);
        }
    });
    for (const auto& run : prepared) {
        if (run) runs_.push_back(*run);
    }
    // Front to back: what is hidden is then found to be so before it is drawn.
    std::ranges::stable_sort(runs_, {}, &PreparedRun::nearestOrder);
}

KeyTile Picture::keyTile(const Rect& area) {
    KeyTile tile;
    tile.x = area.x0;
    tile.y = area.y0;
    tile.width = area.width();
    tile.height = area.height();
    tile.stride = (area.width() + 2 * guard + 7) / 8 * 8;
    const std::size_t size =
        static_cast<std::size_t>(tile.stride) * static_cast<std::size_t>(area.height() + 2 * guard);
    auto& block =
        *buffers_.keys[static_cast<std::size_t>(std::max(0, tbb::this_task_arena::current_thread_index()))];
    Key* const keys = grown(block, size + unusedKeys);
    tile.keys = keys + guard * tile.stride + guard;
    tile.unused = keys + size;
    return tile;
}

void Picture::drawRuns(const Tile& tile, const SplatPass& pass, const KeyTile& keys) {
    for (const std::uint32_t index : tile.runs) {
        const PreparedRun& prepared = runs_[index];
        const Rect part = prepared.bounds.intersect(tile.area);
        if (kernels_.hidden(keys, part.x0 - keys.x, part.y0 - keys.y, part.x1 - keys.x, part.y1 - keys.y,
                            prepared.nearestOrder)) {
            continue;
        }
        SplatRun slice = prepared.run;
        slice.crossesTile =
            part.width() < prepared.bounds.width() || part.height() < prepared.bounds.height();
        for (std::uint32_t first = 0; first < prepared.run.count; first += sliceSamples) {
            if (stop_.stop_requested()) return;
            slice.samples = prepared.run.samples + first;
            slice.count = std::min(sliceSamples, prepared.run.count - first);
            kernels_.splat(pass, slice, keys);
        }
    }
}

void Picture::drawTile(const Tile& tile, const SplatPass& pass, const Surface& surface) {
    const auto start = Clock::now();
    const KeyTile keys = keyTile(tile.area);
    kernels_.clear(keys);
    drawRuns(tile, pass, keys);
    const auto drawn = Clock::now();
    PixelTile pixels;
    pixels.stride = surface.area.width();
    const std::ptrdiff_t offset =
        static_cast<std::ptrdiff_t>(tile.area.y0 - surface.area.y0) * pixels.stride +
        (tile.area.x0 - surface.area.x0);
    pixels.rgba = surface.rgba + offset;
    pixels.depth = surface.depth != nullptr ? surface.depth + offset : nullptr;
    pixels.background = background_.data() + (tile.area.y0 - area_.y0);
    kernels_.resolve(keys, pixels);
    nearestTime_ += nanoseconds(drawn - start);
    resolveTime_ += nanoseconds(Clock::now() - drawn);
}

void Picture::light(const Surface& from, std::uint32_t* out) {
    const int reach = reachOf(plan_.eyeDome);
    const int stride = window_.width() + 2 * reach;
    const int rows = window_.height() + 2 * reach;
    // Beyond the picture's own border lies background, so that every pixel has eight neighbours.
    float* const logs =
        grown(buffers_.logDepth, static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows));
    const int left = from.area.x0 - (window_.x0 - reach), top = from.area.y0 - (window_.y0 - reach);
    overRows(rows, [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) {
            float* const row = logs + static_cast<std::ptrdiff_t>(y) * stride;
            std::fill(row, row + stride, std::numeric_limits<float>::infinity());
            if (y < top || y >= top + from.area.height()) continue;
            kernels_.logDepth(from.depth + static_cast<std::ptrdiff_t>(y - top) * from.area.width(),
                              row + left, from.area.width());
        }
    });
    overRows(window_.height(), [&](int y0, int y1) {
        EyeDome e;
        e.logStride = stride;
        e.logDepth = logs + static_cast<std::ptrdiff_t>(y0 + reach) * stride + reach;
        e.stride = from.area.width();
        e.rgba = from.rgba + static_cast<std::ptrdiff_t>(window_.y0 - from.area.y0 + y0) * e.stride +
                 (window_.x0 - from.area.x0);
        e.width = e.outStride = window_.width();
        e.height = y1 - y0;
        e.out = out + static_cast<std::ptrdiff_t>(y0) * e.outStride;
        setEyeDome(*plan_.eyeDome, e);
        kernels_.eyeDome(e);
    });
}

void Picture::copyDepth(const Surface& from, Frame& frame) {
    const auto width = static_cast<std::ptrdiff_t>(from.area.width());
    for (int y = 0; y < frame.height; ++y) {
        const float* const row =
            from.depth + (window_.y0 - from.area.y0 + y) * width + (window_.x0 - from.area.x0);
        std::copy(row, row + frame.width, frame.depth.data() + static_cast<std::ptrdiff_t>(y) * frame.width);
    }
}

void Picture::drawFrame(const glm::dvec2& jitter, bool first, std::uint32_t* out, Frame& frame) {
    SplatPass pass = pass_;
    pass.centerX = static_cast<float>(drawing_.viewpoint->width * 0.5 + jitter.x);
    pass.centerY = static_cast<float>(drawing_.viewpoint->height * 0.5 + jitter.y);
    Surface surface{window_, out, first ? frame.depth.data() : nullptr};
    if (plan_.eyeDome) {
        const std::size_t pixels =
            static_cast<std::size_t>(area_.width()) * static_cast<std::size_t>(area_.height());
        surface = {area_, grown(buffers_.rgba, pixels), grown(buffers_.depth, pixels)};
    }
    nearestTime_ = resolveTime_ = 0;
    auto start = Clock::now();
    inParallel(static_cast<int>(tiles_.size()),
               [&](int i) { drawTile(tiles_[static_cast<std::size_t>(i)], pass, surface); });
    // Both stages run side by side: the time that passed is shared out by what each thread spent on them.
    const double passed = millisecondsSince(start);
    const double both = std::max(1.0, static_cast<double>(nearestTime_ + resolveTime_));
    frame.stats.add("nearest", passed * static_cast<double>(nearestTime_) / both);
    frame.stats.add("resolve", passed * static_cast<double>(resolveTime_) / both);
    if (!plan_.eyeDome || stop_.stop_requested()) return;
    start = Clock::now();
    light(surface, out);
    if (first) copyDepth(surface, frame);
    frame.stats.add("eyedome", millisecondsSince(start));
}

void Picture::accumulate(const std::uint32_t* rgba) {
    overRows(window_.height(), [&](int y0, int y1) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * window_.width();
        kernels_.accumulate(reinterpret_cast<const std::uint8_t*>(rgba + first),
                            buffers_.sums.data() + 4 * first, 4 * (y1 - y0) * window_.width());
    });
}

void Picture::drawAveraged(Frame& frame) {
    const std::size_t pixels = frame.depth.size();
    std::uint32_t* const one = grown(buffers_.shaded, pixels);
    buffers_.sums.assign(pixels * 4, 0);
    for (std::size_t i = 0; i < drawing_.jitter.size() && !stop_.stop_requested(); ++i) {
        drawFrame(drawing_.jitter[i], i == 0, one, frame);
        const auto start = Clock::now();
        accumulate(one);
        frame.stats.add("average", millisecondsSince(start));
    }
    const auto start = Clock::now();
    overRows(window_.height(), [&](int y0, int y1) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * window_.width();
        kernels_.average(buffers_.sums.data() + 4 * first, frame.rgba.data() + 4 * first,
                         (y1 - y0) * window_.width(), static_cast<int>(drawing_.jitter.size()));
    });
    frame.stats.add("average", millisecondsSince(start));
}

Expected<Frame> Picture::draw() {
    const auto start = Clock::now();
    Frame frame;
    frame.width = window_.width();
    frame.height = window_.height();
    const std::size_t pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    frame.rgba.resize(pixels * 4);
    frame.depth.resize(pixels);
    prepareRuns();
    if (!stop_.stop_requested()) tiles_ = cutIntoTiles(area_, runs_, threads_ * tilesPerThread);
    frame.stats.add("nearest", millisecondsSince(start));
    if (drawing_.jitter.size() == 1) {
        drawFrame(drawing_.jitter[0], true, reinterpret_cast<std::uint32_t*>(frame.rgba.data()), frame);
    } else {
        drawAveraged(frame);
    }
    if (stop_.stop_requested())
        return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
    const Cut& cut = *drawing_.cut;
    frame.stats.samplesDrawn = cut.samples;
    frame.stats.pointsShown = cut.points;
    frame.stats.nodesVisited = cut.nodesVisited;
    frame.stats.nodesCulled = cut.nodesCulled;
    frame.stats.spacingReached = cut.spacingReached;
    frame.stats.device = "cpu";
    return frame;
}

}  // namespace scancast::cpu
