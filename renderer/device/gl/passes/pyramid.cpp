#include "renderer/device/gl/passes/pyramid.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scancast::gl {
namespace {

/// Of reduce.glsl and push.comp.
constexpr int levelsAtOnce = 6, tileSide = 64;
constexpr int normalsPerGroup = 256;

}  // namespace

Pyramid::Pyramid(ScreenShaders& shaders)
    : shaders_(shaders),
      labels_(shaders.functions(), "labels of hidden points"),
      closing_(shaders.functions(), "closing of the background"),
      texels_(shaders.functions(), "pyramid of points"),
      pulled_(shaders.functions(), "pyramid of colours") {}

Expected<void> Pyramid::layOut(const PyramidView& view) {
    shape_ = pyramidShape(view.width, view.height);
    std::size_t texels = 0;
    for (std::size_t k = 1; k < static_cast<std::size_t>(shape_.levels); ++k) {
        first_[k] = static_cast<std::int32_t>(texels);
        texels += static_cast<std::size_t>(shape_.width[k]) * static_cast<std::size_t>(shape_.height[k]);
    }
    const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    const std::size_t bytes = texels * sizeof(vec4);
    if (std::max(bytes, pixels * 9) > shaders_.largestBuffer())
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("A picture of {} x {} px needs a pyramid of {} MiB, more than a shader can "
                                "see here ({} MiB); ask for a smaller one.",
                                view.width, view.height, bytes >> 20, shaders_.largestBuffer() >> 20));
    if (auto ok = labels_.reserve(pixels * 4); !ok) return ok;
    const std::size_t blocks = static_cast<std::size_t>(shape_.width[blockLevel]) *
                               static_cast<std::size_t>(shape_.height[blockLevel]);
    if (auto ok = closing_.reserve((blocks + 2 * pixels) * 4); !ok) return ok;
    if (auto ok = texels_.reserve(bytes); !ok) return ok;
    return pulled_.reserve(bytes);
}

PyramidParams Pyramid::paramsOf(const PyramidView& view) const {
    const Unprojection u = unprojectionOf(view);
    PyramidParams p{};
    p.size = ivec4(view.width, view.height, shape_.levels, shape_.widest);
    p.layerView = vec4(u.centerX, u.centerY, u.step, u.perspective ? 1 : 0);
    for (std::size_t k = 0; k < maxPyramidLevels; ++k)
        p.levels[k] = ivec4(shape_.width[k], shape_.height[k], first_[k], 0);
    return p;
}

void Pyramid::bind(const GpuPlanes& planes) const {
    planes.rgba->bindStorage(BindPlaneRgba);
    planes.depth->bindStorage(BindPlaneDepth);
    if (planes.normals != nullptr) planes.normals->bindStorage(BindPlaneNormals);
    labels_.bindStorage(BindLabels);
    closing_.bindStorage(BindClosing);
    texels_.bindStorage(BindTexels);
    pulled_.bindStorage(BindPulled);
}

Expected<void> Pyramid::overTiles(const char* shader, int level) {
    const std::size_t k = static_cast<std::size_t>(level);
    const auto base = static_cast<std::uint32_t>(level);
    return shaders_.run(shader, tilesOf(shape_.width[k], tileSide), tilesOf(shape_.height[k], tileSide), {},
                        &base);
}

Expected<void> Pyramid::hidePoints(const GpuPlanes& planes, const PyramidView& view,
                                   const HiddenPointsPass& pass) {
    if (auto ok = layOut(view); !ok) return ok;
    const HiddenPointsNumbers numbers = hiddenPointsNumbers(view, pass);
    PyramidParams params = paramsOf(view);
    for (int k = 0; k < maxPyramidLevels; ++k)
        params.farthest[k / 4][k % 4] = numbers.farthest[static_cast<std::size_t>(k)];
    params.hide = vec4(numbers.minGap, numbers.threshold, static_cast<float>(numbers.sureLevel), 0);
    params.closing =
        vec4(numbers.closing.scaled, numbers.closing.least, ClosingSize::most, ClosingSize::nearest);
    params.blocks = ivec4(shape_.width[blockLevel], shape_.height[blockLevel], widestClosing, 0);
    if (auto ok = shaders_.set(params); !ok) return ok;
    bind(planes);
    for (int level = 0; level < shape_.levels - 1; level += levelsAtOnce) {
        if (auto ok = overTiles("point_pyramid.comp", level); !ok) return ok;
    }
    if (auto ok =
            shaders_.run("hide_points.comp", tilesOf(view.width, blockSize), tilesOf(view.height, blockSize));
        !ok)
        return ok;
    return closeBackground(view);
}

Expected<void> Pyramid::closeBackground(const PyramidView& view) {
    for (const std::uint32_t half : {0u, 1u}) {
        if (auto ok = shaders_.run("closing_columns.comp", tilesOf(view.width, 32), tilesOf(view.height, 8),
                                   {}, &half);
            !ok)
            return ok;
        if (auto ok = shaders_.run("closing_rows.comp", tilesOf(view.width, blockSize),
                                   tilesOf(view.height, blockSize), {}, &half);
            !ok)
            return ok;
    }
    return {};
}

Expected<void> Pyramid::showLabels(const GpuPlanes& planes, const PyramidView& view,
                                   const VisibilityPass& pass) {
    const VisibilityColors colors = visibilityColors(pass);
    VisibilityParams params{};
    params.size = ivec4(view.width, view.height, 0, 0);
    params.colors = uvec4(colors.foreground, colors.hidden, colors.hole, 0);
    if (auto ok = shaders_.set(params); !ok) return ok;
    bind(planes);
    return shaders_.overPixels("show_labels.comp", view.width, view.height);
}

Expected<void> Pyramid::fill(const GpuPlanes& planes, const PyramidView& view) {
    if (auto ok = shaders_.set(paramsOf(view)); !ok) return ok;
    bind(planes);
    int level = 0;
    for (; level < shape_.levels - 1; level += levelsAtOnce) {
        if (auto ok = overTiles("pull.comp", level); !ok) return ok;
    }
    while (level > 0) {
        level -= levelsAtOnce;
        if (auto ok = overTiles("push.comp", level); !ok) return ok;
    }
    return {};
}

Expected<void> Pyramid::findNormals(const GpuPlanes& planes, const PyramidView& view,
                                    const DepthNormalsPass& pass) {
    const NormalNumbers numbers = normalNumbers(view, shape_, pass);
    const int first = std::max(numbers.first(), 1), count = numbers.count;
    PyramidParams params = paramsOf(view);
    params.normals = vec4(static_cast<float>(numbers.scaled), static_cast<float>(numbers.least), 0, 0);
    params.normalLevels = ivec4(first, count, 0, 0);
    if (auto ok = shaders_.set(params); !ok) return ok;
    bind(planes);
    if (count > first) {
        const std::size_t last = static_cast<std::size_t>(count - 1);
        const int end = first_[last] + shape_.width[last] * shape_.height[last];
        const int texels = end - first_[static_cast<std::size_t>(first)];
        if (auto ok = shaders_.run("level_normals.comp", tilesOf(texels, normalsPerGroup), 1); !ok) return ok;
    }
    return shaders_.overPixels("pixel_normals.comp", view.width, view.height);
}

}  // namespace scancast::gl
