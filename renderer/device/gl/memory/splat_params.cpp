#include "renderer/device/gl/memory/splat_params.hpp"

#include <algorithm>
#include <bit>

#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast::gl {
namespace {

void setRotation(const SplatPass& n, vec4 (&rows)[3]) {
    for (int r = 0; r < 3; ++r) rows[r] = {n.rotation[r][0], n.rotation[r][1], n.rotation[r][2], 0};
}

std::uint32_t bits(float value) {
    return std::bit_cast<std::uint32_t>(value);
}

}  // namespace

SplatParams splatParams(const SplatPass& n, ivec4 area, std::size_t index, bool byClass) {
    SplatParams p{};
    p.view = {n.centerX, n.centerY, n.near, n.far};
    p.area = area;
    p.size = {n.minPx, n.maxPx, n.radiusPerPixel, n.gain};
    p.ramp = {n.colorLow, n.colorScale, n.intensityLow, n.intensityScale};
    float most = 0.5f * n.maxPx;
    if (n.perspective) most = std::min(most, largestSpread * n.pixelsPerUnit);
    p.surfel = {n.pixelsPerUnit, 1.0f / n.pixelsPerUnit, n.scale, most};
    p.extent = {n.reach, largestReach * n.pixelsPerUnit, n.tolerance, 0};
    p.blur = {6.0f * n.lowPassPx * n.lowPassPx, rootOf6 * n.lowPassPx, majorPerRadius, n.ratioStep};
    setRotation(n, p.rotation);
    p.flags = {static_cast<int>(index), n.facing, 0, n.ownRadii};
    p.filters = {byClass, n.outliers, 0, 0};
    return p;
}

ResolveParams resolveParams(const SplatPass& n, ivec4 area, ivec4 planes, int backgroundRow) {
    ResolveParams p{};
    p.area = area;
    p.planes = planes;
    p.ramp = {n.colorLow, n.colorScale, n.intensityLow, n.intensityScale};
    p.look.z = static_cast<std::uint32_t>(backgroundRow);
    p.view = {n.centerX, n.centerY, 1.0f / n.pixelsPerUnit, n.perspective ? 1.0f : 0.0f};
    p.sprite = {n.minPx, n.maxPx, n.ownRadii ? 1.0f : 0.0f, 0};
    setRotation(n, p.rotation);
    return p;
}

SmoothParams smoothParams(const SplatPass& n, ivec4 planes) {
    SmoothParams p{};
    p.size = {planes.z, planes.w, n.perspective, n.shape == SplatShape::ParaboloidSquare};
    p.bulge.x = n.gain * n.radiusPerPixel;
    return p;
}

void SplatTables::begin(const ColorTables& colors, std::size_t mostRuns) {
    filters = colors.byClass;
    runs.clear();
    runs.reserve(mostRuns);
    words.assign(colors.ramp.begin(), colors.ramp.end());
    words.insert(words.end(), colors.classes.begin(), colors.classes.end());
    std::ranges::transform(surfelRadii(), std::back_inserter(words), bits);
    std::ranges::transform(axisDirections.cosine, std::back_inserter(words), bits);
    std::ranges::transform(axisDirections.sine, std::back_inserter(words), bits);
    words.insert(words.end(), colors.factors.begin(), colors.factors.end());
    std::ranges::transform(curvatureSteps(), std::back_inserter(words), bits);
    words.insert(words.end(), colors.normals.begin(), colors.normals.end());
}

std::uint32_t SplatTables::add(const Node& node, const RunNumbers& run, const RunRegions& crossing) {
    RunFacts out{};
    out.corner = {node.boxMin, node.step.x};
    out.steps = {node.step.y, node.step.z, 0, 0};
    out.clipMin = {run.clipMin[0], run.clipMin[1], run.clipMin[2], static_cast<int>(words.size())};
    out.clipMax = {run.clipMax[0], run.clipMax[1], run.clipMax[2], crossing.dropped | crossing.kept << 16};
    for (const RunRegion& region : crossing.regions) {
        words.push_back(static_cast<std::uint32_t>(region.count));
        for (const auto& plane : region.planes)
            std::ranges::transform(plane, std::back_inserter(words), bits);
    }
    out.factors = {run.indexStep, run.indexBase, run.ratioUnit, run.plainRadius};
    out.color = {run.color, run.lastTurn, run.firstOrdinal,
                 (run.oriented ? 1u : 0u) | (run.hasBeside ? 2u : 0u)};
    filters = filters || run.clipped || !crossing.regions.empty();
    runs.push_back(out);
    return static_cast<std::uint32_t>(runs.size() - 1);
}

}  // namespace scancast::gl
