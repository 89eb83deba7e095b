#include "renderer/device/gl/passes/layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "renderer/device/gl/memory/composed_runs.hpp"
#include "renderer/device/gl/passes/front_to_back.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::gl {
namespace {

constexpr GLbitfield afterSplats =
    GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;

std::size_t pixelsOf(ivec4 area) {
    return static_cast<std::size_t>(area.z) * static_cast<std::size_t>(area.w);
}

/// What is roughly in order, seen from one direction, is so from others that are no further away than this.
constexpr double sameOrderCosine = 0.985;  // 10 degrees

}  // namespace

Expected<std::unique_ptr<Layer>> Layer::create(const LayerParts& parts, const Drawing& drawing,
                                               const CutView& view, const LayerView& layerView,
                                               const FramePasses& passes, ivec4 area) {
    std::unique_ptr<Layer> layer(new Layer(parts, drawing, view, layerView, passes, area));
    std::vector<DrawnRun> drawn = layer->addRuns(drawing, view);
    if (auto ok = layer->upload(); !ok) return passOn(ok);
    layer->findSamples(view.cut, std::move(drawn));
    return layer;
}

Layer::~Layer() {
    // Those of an octree, and all there: the next picture may be of the same runs.
    if (samples_.source != 0 && samples_.samples && samples_.samples->whole())
        parts_.tables.kept = std::move(samples_);
}

void Layer::findSamples(const Cut& cut, std::vector<DrawnRun> drawn) {
    const glm::dmat4& m = layerView_.viewpoint->cloudToView;
    const glm::dvec3 direction(-m[0][2], -m[1][2], -m[2][2]);
    KeptSamples kept = std::exchange(parts_.tables.kept, {});
    const bool same = kept.samples && kept.source == cut.source && kept.runs == drawn;
    if (same && glm::dot(kept.direction, direction) > sameOrderCosine) {
        samples_ = std::move(kept);
        samples_.samples->again();
        return;
    }
    const auto ordered = frontToBack(cut, drawn, *layerView_.viewpoint);
    samples_ = {std::make_unique<CutSamples>(parts_.samples, cut, ordered), cut.source, std::move(drawn),
                direction};
}

Layer::Layer(const LayerParts& parts, const Drawing& drawing, const CutView& view, const LayerView& layerView,
             const FramePasses& passes, ivec4 area)
    : parts_(parts),
      layerView_(layerView),
      passes_(passes),
      area_(area),
      splats_(splatPasses(passes, layerView, drawing.color)),
      background_(
          backgroundRows(drawing.background, area.y - layerView.pad, area.w, layerView.viewpoint->height)),
      byClass_(view.filter.classes.has_value()) {
    for (SplatPass& pass : splats_) pass.outliers = view.filter.outliers;
}

std::vector<DrawnRun> Layer::addRuns(const Drawing& drawing, const CutView& view) {
    const Cut& cut = view.cut;
    const SampleFilter& filter = view.filter;
    SplatTables& tables = parts_.tables.host;
    tables.begin(colorTables(drawing.color, filter), cut.runs.size());
    std::vector<DrawnRun> drawn;
    drawn.reserve(cut.runs.size());
    std::size_t regions = 0;
    runOfCut_.resize(cut.runs.size());
    for (std::uint32_t i = 0; i < cut.runs.size(); ++i) {
        const CutRun& run = cut.runs[i];
        if (run.samples.empty()) continue;
        const auto facts = runFacts(run, layerView_, drawing.color, filter);
        const auto crossing = runRegions(*run.node, filter);
        if (!facts || !crossing) continue;
        runOfCut_[i] = tables.add(*run.node, *facts, *crossing);
        regions = std::max(regions, crossing->regions.size());
        drawn.push_back({i, run.nodeIndex, run.samples.data(), run.samples.size(), run.beside.data()});
    }
    traits_ = {parts_.memory.limits(), tables.filters, splats_.front().silhouette};
    chunkSamples_ = samplesPerChunk;
    for (const SplatPass& pass : splats_)
        chunkSamples_ = std::min(chunkSamples_, chunkSamples(pass, traits_, pixelsOf(area_), regions));
    return drawn;
}

Expected<void> Layer::upload() {
    const std::size_t limit = parts_.memory.limits().storageBlockBytes;
    LayerMemory& tables = parts_.tables;
    SplatTables& host = tables.host;
    if (host.runs.size() > mostComposedRuns || std::as_bytes(std::span(host.runs)).size() > limit ||
        std::as_bytes(std::span(host.words)).size() > limit)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("The cut has {} runs, more than the OpenGL driver takes at once; "
                                "ask for less detail or use --backend=cpu.",
                                host.runs.size()));
    if (auto ok = tables.facts.tell(host.runs, tables.ring); !ok) return ok;
    if (auto ok = tables.lookUps.tell(host.words, tables.ring); !ok) return ok;
    return tables.rows.tell(background_, tables.ring);
}

Expected<void> Layer::begin(const SampleBatch& batch) {
    return parts_.tables.tell(batch, {runOfCut_, chunkSamples_, passes_.bySample()});
}

/// Once: a part of a pixel moves centres, not runs.
Expected<void> Layer::compose() {
    if (std::exchange(composed_, true)) return {};
    LayerMemory& tables = parts_.tables;
    const ComposeParams params = composeParams(*layerView_.viewpoint, splats_, tables.facts.values().size());
    return tables.compose(parts_.screen, params, parts_.exactDoubles);
}

const KeyPlane& Layer::colors() const {
    return passes_.cell ? parts_.memory.cells : parts_.memory.nearest;
}

void Layer::bindColors() const {
    colors().keys.bindTexels(unit::keys);
    if (!traits_.limits.keys64) colors().payloads.bindTexels(unit::payloads);
}

void Layer::bindSurfaces(const KeyPlane& plane) const {
    (traits_.limits.keys64 ? plane.keys : plane.payloads).bindTexels(unit::surfaces);
}

Expected<void> Layer::overPixels(ivec4 area, const ShaderVariant& variant) {
    return parts_.screen.overPixels(variant.shader, area.z, area.w, variant.defines);
}

Expected<void> Layer::splatOnce(const SplatPass& pass, Keep keep, const std::stop_token& stop) {
    const ShaderVariant variant = splatVariant(pass, traits_, keep);
    const auto program = parts_.programs.get(variant.shader, variant.defines);
    if (!program) return passOn(program);
    (*program)->use();
    const auto drawBatch = [&](const SampleBatch& batch) -> Expected<void> {
        if (auto ok = begin(batch); !ok) return ok;
        parts_.tables.chunks.bindStorage(binding::splat::chunks);
        for (std::size_t i = 0; i < batch.pages.size(); ++i) {
            batch.pages[i].texels->bind(unit::samples);
            const BatchTables::PageWork& work = parts_.tables.batch.pages[i];
            if (auto ok = parts_.slices.dispatch(work.firstChunk, work.chunks, stop); !ok) return ok;
        }
        return {};
    };
    auto drawn = samples_.samples->forEachBatch(drawBatch, stop);
    parts_.gl.MemoryBarrier(afterSplats);
    return drawn;
}

Expected<void> Layer::splatKeys(const SplatPass& pass, KeyPlane& into, std::size_t pixels,
                                const std::stop_token& stop) {
    into.keys.clear(pixels);
    into.keys.bindStorage(binding::splat::keys);
    if (traits_.limits.keys64) return splatOnce(pass, Keep::Key, stop);
    auto drawn = splatOnce(pass, Keep::Order, stop);
    if (!drawn) return drawn;
    into.keys.bindTexels(unit::keys);
    into.payloads.clear(pixels);
    into.payloads.bindStorage(binding::splat::payloads);
    return splatOnce(pass, Keep::Payload, stop);
}

Expected<void> Layer::splat(std::size_t index, const SplatPass& pass, ivec4 band,
                            const std::stop_token& stop) {
    SplatMemory& memory = parts_.memory;
    const std::size_t pixels = pixelsOf(band);
    if (auto ok = parts_.screen.set(splatParams(pass, band, index, byClass_)); !ok) return ok;
    parts_.tables.runs.bindStorage(binding::runs);
    parts_.tables.lookUps.buffer().bindStorage(binding::tables);
    if (traits_.silhouette) memory.silhouette.bindTexels(unit::silhouette);
    if (pass.reduction != Reduction::Nearest) {
        memory.nearest.keys.bindTexels(unit::visible);
        bindSurfaces(pass.reduction == Reduction::Cell ? memory.nearest : colors());
    }
    if (pass.silhouette) {
        memory.silhouette.clear(pixels);
        memory.silhouette.bindStorage(binding::splat::keys);
        return splatOnce(pass, Keep::Order, stop);
    }
    switch (pass.reduction) {
        case Reduction::Nearest:
            return splatKeys(pass, memory.nearest, pixels, stop);
        case Reduction::Sum:
            memory.sums.clear(pixels * sumWords(passes_), 0);
            memory.sums.bindStorage(binding::splat::sums);
            return splatOnce(pass, Keep::Order, stop);
        case Reduction::Cell:
            return splatKeys(pass, memory.cells, pixels, stop);
    }
    return {};
}

Expected<void> Layer::resolveKeys(const ResolveParams& params, const GpuPlanes& planes, bool normals) {
    namespace at = binding::resolveKeys;
    if (auto ok = parts_.screen.set(params); !ok) return ok;
    bindColors();
    if (passes_.cell) parts_.memory.nearest.keys.bindTexels(unit::visible);
    planes.rgba->bindStorage(at::rgba);
    planes.depth->bindStorage(at::depth);
    if (normals) planes.normals->bindStorage(at::normals);
    parts_.tables.rows.buffer().bindStorage(at::background);
    return overPixels(params.area, resolveKeysVariant(passes_, traits_.limits.keys64, normals));
}

Expected<void> Layer::resolveSamples(ResolveParams params, const GpuPlanes& planes, bool normals,
                                     const std::stop_token& stop) {
    namespace at = binding::resolveSamples;
    const bool owners = passes_.resolve.smooth;
    const ShaderVariant variant =
        resolveSamplesVariant(splats_.front(), traits_.limits.keys64, normals, owners);
    parts_.tables.runs.bindStorage(binding::runs);
    parts_.tables.lookUps.buffer().bindStorage(binding::tables);
    bindColors();
    planes.rgba->bindStorage(at::rgba);
    planes.depth->bindStorage(at::depth);
    if (normals) planes.normals->bindStorage(at::normals);
    if (owners) {
        parts_.memory.places.bindStorage(at::places);
        parts_.memory.halves.bindStorage(at::halves);
    }
    const auto look = [&](const SampleBatch& batch) -> Expected<void> {
        if (auto ok = begin(batch); !ok) return ok;
        parts_.tables.extents.bindStorage(at::extents);
        for (std::size_t i = 0; i < batch.pages.size(); ++i) {
            const BatchTables::PageWork& work = parts_.tables.batch.pages[i];
            if (work.extents == 0) continue;
            params.look.x = work.firstExtent;
            params.look.y = work.extents;
            if (auto ok = parts_.screen.set(params); !ok) return ok;
            batch.pages[i].texels->bind(unit::samples);
            if (auto ok = overPixels(params.area, variant); !ok) return ok;
        }
        return {};
    };
    return samples_.samples->forEachBatch(look, stop);
}

Expected<void> Layer::resolveSums(const ResolveParams& params, const GpuPlanes& planes, bool normals) {
    namespace at = binding::resolveSums;
    if (auto ok = parts_.screen.set(params); !ok) return ok;
    bindColors();
    parts_.memory.sums.bindStorage(at::sums);
    planes.rgba->bindStorage(at::rgba);
    if (normals) planes.normals->bindStorage(at::normals);
    return overPixels(params.area, resolveSumsVariant(passes_, traits_.limits.keys64, normals));
}

Expected<void> Layer::resolve(const SplatPass& pass, ivec4 band, const GpuPlanes& planes,
                              const std::stop_token& stop) {
    const bool normals = passes_.resolve.normals && planes.normals != nullptr;
    const ResolveParams params = resolveParams(pass, band, planes.area, band.y - area_.y);
    Expected<void> done = resolveKeys(params, planes, normals);
    if (done && passes_.bySample()) done = resolveSamples(params, planes, normals, stop);
    if (done && passes_.resolve.sums) done = resolveSums(params, planes, normals);
    return done;
}

Expected<void> Layer::drawBand(ivec4 band, std::span<const SplatPass> splats, const GpuPlanes& planes,
                               StageTimes& times, const std::stop_token& stop) {
    for (std::size_t i = 0; i < splats.size(); ++i) {
        const char* const name = nameOf(splats[i]);
        const StageTimes::Scope timed(times, name);
        if (auto ok = compose(); !ok) return ok;
        if (auto ok = splat(i, splats[i], band, stop); !ok) return ok;
        if (auto ok = checkErrors(parts_.gl, std::string("splatting \"") + name + "\""); !ok) return ok;
    }
    const StageTimes::Scope timed(times, "resolve");
    if (auto ok = resolve(splats.front(), band, planes, stop); !ok) return ok;
    return checkErrors(parts_.gl, "resolving splats");
}

/// Of the whole layer, since each pixel looks at its neighbours, whatever band and page they come from.
Expected<void> Layer::smooth(const SplatPass& pass, const GpuPlanes& planes) {
    namespace at = binding::smooth;
    if (auto ok = parts_.screen.set(smoothParams(pass, planes.area)); !ok) return ok;
    const SplatMemory& memory = parts_.memory;
    memory.places.bindStorage(at::places);
    memory.halves.bindStorage(at::halves);
    planes.depth->bindStorage(at::depth);
    planes.rgba->bindStorage(at::rgba);
    memory.smoothed.bindStorage(at::smoothed);
    if (auto ok = overPixels(planes.area, {"smooth.comp", {}}); !ok) return ok;
    parts_.gl.CopyNamedBufferSubData(memory.smoothed.name(), planes.rgba->name(), 0, 0,
                                     static_cast<GLsizeiptr>(planes.pixels() * 4));
    return checkErrors(parts_.gl, "smoothing borders");
}

/// What the first pass would do when it is asked for, done before: the GPU need not wait for it within a
/// pass.
Expected<void> Layer::gather(StageTimes& times, const std::stop_token& stop) {
    const StageTimes::HostScope timed(times, "prepare");
    const auto batch = samples_.samples->gather(stop);
    if (!batch) return passOn(batch);
    return begin(*batch);
}

Expected<void> Layer::draw(const glm::dvec2& jitter, const GpuPlanes& planes, StageTimes& times,
                           const std::stop_token& stop) {
    if (auto ok = gather(times, stop); !ok) return ok;
    std::vector<SplatPass> splats = splats_;
    for (SplatPass& pass : splats) pass = jittered(pass, layerView_, jitter);
    // As many rows at a time as sums and keys fit a storage block.
    const std::size_t most = parts_.memory.mostPixels(passes_) / static_cast<std::size_t>(area_.z);
    const int rows = static_cast<int>(std::clamp<std::size_t>(most, 1, static_cast<std::size_t>(area_.w)));
    if (auto ok = parts_.memory.reserve(passes_, static_cast<std::size_t>(rows * area_.z)); !ok) return ok;
    const bool smoothed = passes_.resolve.smooth;
    if (auto ok = smoothed ? parts_.memory.reserveOwners(planes.pixels()) : Expected<void>(); !ok) return ok;
    for (int y = 0; y < area_.w; y += rows) {
        const ivec4 band(area_.x, area_.y + y, area_.z, std::min(rows, area_.w - y));
        if (auto ok = drawBand(band, splats, planes, times, stop); !ok) return ok;
    }
    if (!smoothed) return {};
    const StageTimes::Scope timed(times, "smooth");
    return smooth(splats.front(), planes);
}

}  // namespace scancast::gl
