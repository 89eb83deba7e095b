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
#include "renderer/device/cpu/kernels/sprites/nearest.hpp"
#include "renderer/device/cpu/kernels/sprites/sums.hpp"
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

void splatFrames(const SplatPass& pass, const SplatRun& run, const FrameTile* frames, int count) {
    switch (pass.shape) {
        case Shape::FlatSquare:
            return splatSprites<Shape::FlatSquare>(pass, run, frames, count);
        case Shape::FlatCircle:
            return splatSprites<Shape::FlatCircle>(pass, run, frames, count);
        case Shape::ParaboloidSquare:
            return splatSprites<Shape::ParaboloidSquare>(pass, run, frames, count);
        case Shape::ParaboloidCircle:
            return splatSprites<Shape::ParaboloidCircle>(pass, run, frames, count);
        case Shape::ConeSquare:
            return splatSprites<Shape::ConeSquare>(pass, run, frames, count);
        case Shape::ConeCircle:
            return splatSprites<Shape::ConeCircle>(pass, run, frames, count);
        case Shape::SphereCircle:
            return splatSprites<Shape::SphereCircle>(pass, run, frames, count);
        case Shape::Disc:
        case Shape::Ellipse:
            return;  // not sprites
    }
}

std::uint32_t splat(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    if (isSurfel(pass.shape)) return splatSurfels(pass, run, tile);
    if (pass.reduction == Reduction::Sum) return sumCircles(pass, run, tile);
    const FrameTile frame{pass.centerX, pass.centerY, tile};
    splatFrames(pass, run, &frame, 1);
    return run.count;
}

}  // namespace

const Kernels kernels = {
    .clear = clear,
    .splat = splat,
    .splatFrames = splatFrames,
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
