// What one picture asks of the GPU, laid out before the GPU is touched: which variant of the shaders, their
// parameters, the runs composed in double, samples dealt out to pages and work groups. Pure functions; any
// thread. Pipeline: drawing → **draw plan** → passes (gl_passes.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/device/gl/gl_layouts.hpp"
#include "renderer/device/gl/shader_source.hpp"
#include "renderer/device/splat_kind.hpp"

namespace scancast::gl {

using Shape = SplatShape;
using Coloring = SplatColoring;

/// What shaders are compiled for; the rest is parameters.
struct NearestVariant {
    Shape shape = Shape::FlatSquare;
    Coloring coloring = Coloring::Rgb;
    bool perspective = true, singlePixel = true, classes = false, clipped = false;
    /// The #defines of nearest.comp; `stage` 0 = order, 1 = payload.
    std::vector<Define> defines(int stage) const;
};

struct SamplePage {
    std::vector<std::span<const Sample>> segments;  ///< stand in the page back to back
    std::uint32_t samples = 0;
    std::uint32_t firstChunk = 0, chunks = 0;  ///< in DrawPlan::chunks
};

struct DrawPlan {
    NearestVariant variant;
    PassParams pass;    ///< view.xy without jitter
    glm::dvec2 center;  ///< the view axis, px in the whole picture: view.xy before jitter
    std::vector<RunParams> runs;
    std::vector<Chunk> chunks;
    std::vector<SamplePage> pages;
    std::vector<std::uint32_t> colors;  ///< 256 of the ramp, 256 class flags, 65,536 of normals where needed
    std::vector<std::uint32_t> background;  ///< one rgba per row of the area
    std::optional<EyeDomeParams> eyeDome;
    ivec4 window;  ///< x, y, width, height in the whole picture
};

/// What the driver allows.
struct GlLimits {
    std::size_t storageBlockBytes = std::size_t{128} << 20;
};

inline constexpr std::uint32_t chunkSamples = 1024;
inline constexpr std::size_t largestPageBytes = std::size_t{64} << 20;

/// Unsupported for a list that is not nearest, resolve and at most one eye-dome pass; InvalidArgument for a
/// window outside the picture; ResourceLimit for one that does not fit a storage block.
Expected<DrawPlan> planDrawing(const Drawing& drawing, const GlLimits& limits);

}  // namespace scancast::gl
