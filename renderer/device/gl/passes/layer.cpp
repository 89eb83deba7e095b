#include "renderer/device/gl/passes/layer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "renderer/device/plan/splat_plan.hpp"

namespace scancast::gl {
namespace {

constexpr GLbitfield afterSplats =
    GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;
constexpr const char* stageNames[] = {"silhouette", "nearest", "sum", "cell"};

std::size_t pixelsOf(ivec4 area) {
    return static_cast<std::size_t>(area.z) * static_cast<std::size_t>(area.w);
}

/// Depth of the nearest that a node may hold, within what may be drawn.
float frontOf(const Node& node, const Viewpoint& viewpoint) {
    const glm::dmat4& m = viewpoint.cloudToView;
    const double depth =
        -(m[0][2] * node.center.x + m[1][2] * node.center.y + m[2][2] * node.center.z + m[3][2]);
    return static_cast<float>(
        std::clamp(depth - node.radius, 0.0, std::min(viewpoint.far, double(farthestDepth))));
}

/// Roughly front to back, by one count: what is hidden then seldom needs an atomic operation, and nothing
/// else depends on it. `depths[i]` is the i-th run's.
std::vector<std::uint32_t> frontToBack(std::span<const std::uint32_t> runs, std::span<const float> depths) {
    constexpr std::size_t steps = 1024;
    if (runs.empty()) return {};
    const auto [first, last] = std::ranges::minmax(depths);
    const double scale = last > first ? (steps - 1) / (double(last) - first) : 0;
    const auto stepOf = [&, first = double(first)](float depth) {
        return static_cast<std::size_t>((depth - first) * scale);
    };
    std::array<std::uint32_t, steps + 1> begins{};
    for (const float depth : depths) ++begins[stepOf(depth) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<std::uint32_t> sorted(runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) sorted[begins[stepOf(depths[i])]++] = runs[i];
    return sorted;
}

}  // namespace

Expected<std::unique_ptr<Layer>> Layer::create(const LayerParts& parts, const Drawing& drawing,
                                               const Cut& cut, const SampleFilter& filter, const Sight& sight,
                                               const PassPlan& plan, ivec4 area) {
    std::unique_ptr<Layer> layer(new Layer(parts, drawing, filter, sight, plan, area));
    const std::vector<std::uint32_t> drawn = layer->addRuns(drawing, cut, filter);
    if (auto made = layer->upload(); !made) return tl::unexpected(made.error());
    layer->samples_ = std::make_unique<CutSamples>(parts.samples, cut, drawn);
    return layer;
}

Layer::Layer(const LayerParts& parts, const Drawing& drawing, const SampleFilter& filter, const Sight& sight,
             const PassPlan& plan, ivec4 area)
    : parts_(parts),
      sight_(sight),
      plan_(plan),
      area_(area),
      stages_(splatStages(plan, sight, drawing.color)),
      tables_(parts.tables.host),
      background_(backgroundRows(drawing.background, area.y - sight.pad, area.w, sight.viewpoint->height)),
      byClass_(filter.classes.has_value()) {}

std::vector<std::uint32_t> Layer::addRuns(const Drawing& drawing, const Cut& cut,
                                          const SampleFilter& filter) {
    tables_.begin(colorTables(drawing.color, filter), cut.runs.size());
    std::vector<std::uint32_t> drawn;
    std::vector<float> depths;
    drawn.reserve(cut.runs.size());
    depths.reserve(cut.runs.size());
    std::size_t regions = 0;
    runOfCut_.resize(cut.runs.size());
    for (std::uint32_t i = 0; i < cut.runs.size(); ++i) {
        const CutRun& run = cut.runs[i];
        if (run.samples.empty()) continue;
        const auto numbers = runNumbers(run, sight_, drawing.color, filter);
        const auto dropped = droppedRegions(*run.node, filter);
        if (!numbers || !dropped) continue;
        runOfCut_[i] = tables_.add(*numbers, *dropped, stages_, *sight_.viewpoint);
        regions = std::max(regions, dropped->size());
        drawn.push_back(i);
        depths.push_back(frontOf(*run.node, *sight_.viewpoint));
    }
    traits_ = {parts_.memory.limits(), tables_.filters, stages_.front().kind == SplatStage::Kind::Silhouette};
    chunkSamples_ = samplesPerChunk;
    for (const SplatStage& stage : stages_)
        chunkSamples_ = std::min(chunkSamples_, chunkSamples(stage, traits_, pixelsOf(area_), regions));
    return frontToBack(drawn, depths);
}

Expected<void> Layer::upload() {
    const std::size_t limit = parts_.memory.limits().storageBlockBytes;
    if (std::as_bytes(std::span(tables_.runs)).size() > limit ||
        std::as_bytes(std::span(tables_.words)).size() > limit)
        return fail(ErrorCode::ResourceLimit,
                    "The cut has " + std::to_string(tables_.runs.size()) +
                        " runs, more than the OpenGL driver takes at once; ask for less detail or use "
                        "--backend=cpu.");
    LayerMemory& tables = parts_.tables;
    if (auto filled = tables.fill(tables.runs, tables_.runs); !filled) return filled;
    if (auto filled = tables.fill(tables.lookUps, tables_.words); !filled) return filled;
    return tables.fill(tables.rows, background_);
}

Expected<void> Layer::begin(const SampleBatch& batch) {
    if (batch.version == version_) return {};
    LayerMemory& tables = parts_.tables;
    std::vector<SplatChunk>& chunks = tables.chunkList;
    std::vector<SplatExtent>& extents = tables.extentList;
    chunks.clear();
    extents.clear();
    pages_.clear();
    for (const SampleBatch::Page& page : batch.pages) {
        PageWork work;
        work.firstChunk = static_cast<std::uint32_t>(chunks.size());
        work.firstExtent = static_cast<std::uint32_t>(extents.size());
        for (const Extent& e : page.extents) {
            const std::uint32_t run = runOfCut_[e.run];
            if (plan_.bySample())
                extents.push_back({uvec4(tables_.runs[run].color.z + e.first, e.count, run, e.at)});
            for (std::uint32_t i = 0; i < e.count; i += chunkSamples_)
                chunks.push_back({uvec4(e.at + i, std::min(chunkSamples_, e.count - i), run, e.first + i)});
        }
        std::sort(extents.begin() + work.firstExtent, extents.end(),
                  [](const SplatExtent& a, const SplatExtent& b) { return a.range.x < b.range.x; });
        work.chunks = static_cast<std::uint32_t>(chunks.size()) - work.firstChunk;
        work.extents = static_cast<std::uint32_t>(extents.size()) - work.firstExtent;
        pages_.push_back(work);
    }
    version_ = 0;
    if (auto filled = tables.fill(tables.chunks, chunks); !filled) return filled;
    if (auto filled = tables.fill(tables.extents, extents); !filled) return filled;
    version_ = batch.version;
    return {};
}

const KeyPlane& Layer::colors() const {
    return plan_.cell ? parts_.memory.cells : parts_.memory.nearest;
}

void Layer::bindColors() const {
    colors().keys.bindTexels(unit::keys);
    if (!traits_.limits.keys64) colors().payloads.bindTexels(unit::payloads);
}

Expected<void> Layer::overPixels(ivec4 area, const ShaderVariant& variant) {
    return parts_.screen.overPixels(variant.shader, area.z, area.w, variant.defines);
}

Expected<void> Layer::splatOnce(const SplatStage& stage, Keep keep, const std::stop_token& stop) {
    const ShaderVariant variant = splatVariant(stage, traits_, keep);
    const auto program = parts_.programs.get(variant.shader, variant.defines);
    if (!program) return tl::unexpected(program.error());
    (*program)->use();
    const auto drawBatch = [&](const SampleBatch& batch) -> Expected<void> {
        if (auto begun = begin(batch); !begun) return begun;
        parts_.tables.chunks.bindStorage(binding::splat::chunks);
        for (std::size_t i = 0; i < batch.pages.size(); ++i) {
            batch.pages[i].samples->bind(unit::samples);
            if (auto done = parts_.slices.dispatch(pages_[i].firstChunk, pages_[i].chunks, stop); !done)
                return done;
        }
        return {};
    };
    auto drawn = samples_->forEachBatch(drawBatch, stop);
    parts_.gl.MemoryBarrier(afterSplats);
    return drawn;
}

Expected<void> Layer::splatKeys(const SplatStage& stage, KeyPlane& into, std::size_t pixels, bool payloads,
                                const std::stop_token& stop) {
    into.keys.clear(pixels);
    into.keys.bindStorage(binding::splat::keys);
    if (traits_.limits.keys64) return splatOnce(stage, Keep::Key, stop);
    auto drawn = splatOnce(stage, Keep::Order, stop);
    if (!drawn || !payloads) return drawn;
    into.keys.bindTexels(unit::keys);
    into.payloads.clear(pixels);
    into.payloads.bindStorage(binding::splat::payloads);
    return splatOnce(stage, Keep::Payload, stop);
}

Expected<void> Layer::splat(std::size_t index, const SplatStage& stage, ivec4 band,
                            const std::stop_token& stop) {
    using enum SplatStage::Kind;
    SplatMemory& memory = parts_.memory;
    const std::size_t pixels = pixelsOf(band);
    if (auto set = parts_.screen.set(splatParams(stage.numbers, band, index, byClass_)); !set) return set;
    parts_.tables.runs.bindStorage(binding::runs);
    parts_.tables.lookUps.bindStorage(binding::tables);
    if (traits_.silhouette) memory.silhouette.bindTexels(unit::silhouette);
    if (stage.kind == Sum || stage.kind == Cell) memory.nearest.keys.bindTexels(unit::visible);
    switch (stage.kind) {
        case Silhouette:
            memory.silhouette.clear(pixels);
            memory.silhouette.bindStorage(binding::splat::keys);
            return splatOnce(stage, Keep::Order, stop);
        case Nearest:
            // Where there are cells, theirs are the colours.
            return splatKeys(stage, memory.nearest, pixels, !plan_.cell, stop);
        case Sum:
            memory.sums.clear(pixels * sumWords(plan_), 0);
            memory.sums.bindStorage(binding::splat::sums);
            return splatOnce(stage, Keep::Order, stop);
        case Cell:
            return splatKeys(stage, memory.cells, pixels, true, stop);
    }
    return {};
}

Expected<void> Layer::resolveKeys(const ResolveParams& params, const GpuPlanes& planes, bool normals) {
    namespace at = binding::resolveKeys;
    if (auto set = parts_.screen.set(params); !set) return set;
    bindColors();
    if (plan_.cell) parts_.memory.nearest.keys.bindTexels(unit::visible);
    planes.rgba->bindStorage(at::rgba);
    planes.depth->bindStorage(at::depth);
    if (normals) planes.normals->bindStorage(at::normals);
    parts_.tables.rows.bindStorage(at::background);
    return overPixels(params.area, resolveKeysVariant(plan_, traits_.limits.keys64, normals));
}

Expected<void> Layer::resolveSamples(ResolveParams params, const GpuPlanes& planes, bool normals,
                                     const std::stop_token& stop) {
    namespace at = binding::resolveSamples;
    const ShaderVariant variant =
        resolveSamplesVariant(stages_.front().numbers.coloring, traits_.limits.keys64, normals);
    parts_.tables.runs.bindStorage(binding::runs);
    parts_.tables.lookUps.bindStorage(binding::tables);
    bindColors();
    planes.rgba->bindStorage(at::rgba);
    planes.depth->bindStorage(at::depth);
    if (normals) planes.normals->bindStorage(at::normals);
    const auto look = [&](const SampleBatch& batch) -> Expected<void> {
        if (auto begun = begin(batch); !begun) return begun;
        parts_.tables.extents.bindStorage(at::extents);
        for (std::size_t i = 0; i < batch.pages.size(); ++i) {
            if (pages_[i].extents == 0) continue;
            params.look.x = pages_[i].firstExtent;
            params.look.y = pages_[i].extents;
            if (auto set = parts_.screen.set(params); !set) return set;
            batch.pages[i].samples->bind(unit::samples);
            if (auto done = overPixels(params.area, variant); !done) return done;
        }
        return {};
    };
    return samples_->forEachBatch(look, stop);
}

Expected<void> Layer::resolveSums(const ResolveParams& params, const GpuPlanes& planes, bool normals) {
    namespace at = binding::resolveSums;
    if (auto set = parts_.screen.set(params); !set) return set;
    bindColors();
    parts_.memory.sums.bindStorage(at::sums);
    planes.rgba->bindStorage(at::rgba);
    if (normals) planes.normals->bindStorage(at::normals);
    return overPixels(params.area, resolveSumsVariant(plan_, traits_.limits.keys64, normals));
}

Expected<void> Layer::resolve(ivec4 band, const GpuPlanes& planes, const std::stop_token& stop) {
    const bool normals = plan_.resolve.normals && planes.normals != nullptr;
    const ResolveParams params = resolveParams(stages_.front().numbers, band, planes.area, band.y - area_.y);
    Expected<void> done = resolveKeys(params, planes, normals);
    if (done && plan_.bySample()) done = resolveSamples(params, planes, normals, stop);
    if (done && plan_.resolve.sums) done = resolveSums(params, planes, normals);
    return done;
}

Expected<void> Layer::drawBand(ivec4 band, std::span<const SplatStage> stages, const GpuPlanes& planes,
                               StageTimes& times, const std::stop_token& stop) {
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const char* const name = stageNames[static_cast<std::size_t>(stages[i].kind)];
        const StageTimes::Scope timed(times, name);
        if (auto drawn = splat(i, stages[i], band, stop); !drawn) return drawn;
        if (auto checked = checkErrors(parts_.gl, std::string("splatting \"") + name + "\""); !checked)
            return checked;
    }
    const StageTimes::Scope timed(times, "resolve");
    if (auto resolved = resolve(band, planes, stop); !resolved) return resolved;
    return checkErrors(parts_.gl, "resolving splats");
}

/// What the first pass would do when it is asked for, done before: the GPU need not wait for it within a
/// pass.
Expected<void> Layer::gather(StageTimes& times, const std::stop_token& stop) {
    const StageTimes::HostScope timed(times, "prepare");
    const auto batch = samples_->gather(stop);
    if (!batch) return tl::unexpected(batch.error());
    return begin(*batch);
}

Expected<void> Layer::draw(const glm::dvec2& jitter, const GpuPlanes& planes, StageTimes& times,
                           const std::stop_token& stop) {
    if (auto gathered = gather(times, stop); !gathered) return gathered;
    std::vector<SplatStage> stages = stages_;
    for (SplatStage& stage : stages) stage.numbers = jittered(stage.numbers, sight_, jitter);
    // As many rows at a time as sums and keys fit a storage block.
    const std::size_t most = parts_.memory.mostPixels(plan_) / static_cast<std::size_t>(area_.z);
    const int rows = static_cast<int>(std::clamp<std::size_t>(most, 1, static_cast<std::size_t>(area_.w)));
    if (auto made = parts_.memory.reserve(plan_, static_cast<std::size_t>(rows * area_.z)); !made)
        return made;
    for (int y = 0; y < area_.w; y += rows) {
        const ivec4 band(area_.x, area_.y + y, area_.z, std::min(rows, area_.w - y));
        if (auto drawn = drawBand(band, stages, planes, times, stop); !drawn) return drawn;
    }
    return {};
}

}  // namespace scancast::gl
