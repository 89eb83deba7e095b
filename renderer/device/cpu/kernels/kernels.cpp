// Compiled once per SIMD level, with SCANCAST_SIMD_LEVEL = 2, 3 or 4 and the matching -march: see kernels.hpp
// for what that forbids in here.
#include "renderer/device/cpu/kernels/kernels.hpp"
#include "renderer/device/cpu/kernels/closing.hpp"

#include "renderer/device/cpu/kernels/depth_normals.hpp"
#include "renderer/device/cpu/kernels/glass.hpp"
#include "renderer/device/cpu/kernels/hidden_points.hpp"
#include "renderer/device/cpu/kernels/occlusion.hpp"
#include "renderer/device/cpu/kernels/pull_push.hpp"
#include "renderer/device/cpu/kernels/resolve.hpp"
#include "renderer/device/cpu/kernels/screen.hpp"
#include "renderer/device/cpu/kernels/shade.hpp"
#include "renderer/device/cpu/kernels/smooth.hpp"
#include "renderer/device/cpu/kernels/splat.hpp"
#include "renderer/device/cpu/kernels/splat_sums.hpp"
#include "renderer/device/cpu/kernels/surfels.hpp"

#if SCANCAST_SIMD_LEVEL == 4
#define SCANCAST_SIMD_NAMESPACE v4
#elif SCANCAST_SIMD_LEVEL == 3
#define SCANCAST_SIMD_NAMESPACE v3
#else
#define SCANCAST_SIMD_NAMESPACE v2
#endif

namespace scancast::cpu::SCANCAST_SIMD_NAMESPACE {
namespace {

/// Sprites of the shape, nearest.
template <Shape shape>
std::uint32_t nearest(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    splatSprites<shape>(pass, run, tile);
    return run.count;
}

std::uint32_t splat(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    switch (pass.shape) {
        case Shape::FlatSquare:
            return nearest<Shape::FlatSquare>(pass, run, tile);
        case Shape::FlatCircle:
            return pass.reduction == Reduction::Sum ? sumCircles(pass, run, tile)
                                                    : nearest<Shape::FlatCircle>(pass, run, tile);
        case Shape::ParaboloidSquare:
            return nearest<Shape::ParaboloidSquare>(pass, run, tile);
        case Shape::ParaboloidCircle:
            return nearest<Shape::ParaboloidCircle>(pass, run, tile);
        case Shape::ConeSquare:
            return nearest<Shape::ConeSquare>(pass, run, tile);
        case Shape::ConeCircle:
            return nearest<Shape::ConeCircle>(pass, run, tile);
        case Shape::SphereCircle:
            return nearest<Shape::SphereCircle>(pass, run, tile);
        case Shape::Disc:
        case Shape::Ellipse:
            return splatSurfels(pass, run, tile);
    }
    return run.count;
}

}  // namespace

const Kernels kernels = {
    .clear = clear,
    .splat = splat,
    .hidden = hidden,
    .resolve = resolve,
    .resolveSamples = resolveSamples,
    .resolveSums = resolveSums,
    .smooth = smooth,
    .phong = phong,
    .shadow = shadow,
    .logDepth = logDepth,
    .eyeDome = eyeDome,
    .nearness = nearness,
    .occlude = occlude,
    .lookThrough = lookThrough,
    .tintGlass = tintGlass,
    .accumulate = accumulate,
    .average = average,
    .pyramid =
        {
            .copyDepth = copyDepth,
            .firstPoints = firstPoints,
            .nextPoints = nextPoints,
            .hidePoints = hidePoints,
            .closingColumns = closingColumns,
            .closingRows = closingRows,
            .pullPicture = pullPicture,
            .pull = pull,
            .push = push,
            .pushPicture = pushPicture,
            .levelNormals = levelNormals,
            .pixelNormals = pixelNormals,
        },
};

}  // namespace scancast::cpu::SCANCAST_SIMD_NAMESPACE
