// The picture that a perfect renderer would draw of a simulated scan, without shading of its own: what
// methods are measured against. Pipeline: scene + viewpoint → **ground truth** → PSNR, SSIM, holes.
#pragma once

#include "renderer/image/frame.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/ground_truth/ray_caster.hpp"

namespace scancast {

struct CastOptions {
    int supersampling = 4;  ///< n: each pixel's colour is the mean of n × n rays, 1 … 64
    /// What the viewpoint's coordinates are relative to: Cloud::origin of the cloud made of the points.
    glm::dvec3 cloudOrigin{0};
    Glass glass = Glass::Reflects;
    int threads = 0;  ///< 0 = all cores; the picture does not depend on it
};

/// Row 0 is the top; all vectors have width × height entries.
struct GroundTruth {
    int width = 0, height = 0;
    std::vector<glm::vec3> color;  ///< mean of the pixel's rays that met something, sRGB, 0 … 1
    std::vector<float> coverage;   ///< part of the pixel's rays that met something
    /// Of the ray through the pixel's centre: depth as in Frame (+infinity = nothing) and the surface's
    /// normal, turned towards the eye, in cloud coordinates (0 = nothing).
    std::vector<float> depth;
    std::vector<glm::vec3> normal;

    std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
    /// 1 where all rays of a pixel met something, else 0: the silhouette, for counting holes.
    std::vector<std::uint8_t> silhouette() const;
    /// The picture over a background, opaque, with depth.
    Frame frame(const std::array<std::uint8_t, 3>& background = {0, 0, 0}) const;
};

/// The same bytes on any number of threads. Errors: InvalidArgument for a supersampling out of range or a
/// viewpoint without pixels; ResourceLimit.
Expected<GroundTruth> castRays(const RayCaster& caster, const Viewpoint& viewpoint,
                               const CastOptions& options);

}  // namespace scancast
