#include "tests/ground_truth/ground_truth.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <new>

namespace scancast {
namespace {

/// Rays through places of the picture; t is the depth.
class RayMaker {
  public:
    RayMaker(const Viewpoint& viewpoint, const glm::dvec3& cloudOrigin)
        : viewpoint_(viewpoint),
          toCloud_(glm::transpose(glm::dmat3(viewpoint.cloudToView))),
          eye_(cloudOrigin - toCloud_ * glm::dvec3(viewpoint.cloudToView[3])) {}

    Ray through(double x, double y) const {
        const double right = (x - viewpoint_.width * 0.5) / viewpoint_.pixelsPerUnit,
                     up = (viewpoint_.height * 0.5 - y) / viewpoint_.pixelsPerUnit;
        if (viewpoint_.projection == Projection::Perspective)
            return {eye_, toCloud_ * glm::dvec3(right, up, -1)};
        return {eye_ + toCloud_ * glm::dvec3(right, up, 0), toCloud_ * glm::dvec3(0, 0, -1)};
    }

  private:
    const Viewpoint& viewpoint_;
    glm::dmat3 toCloud_;
    glm::dvec3 eye_;
};

void castPixel(const RayCaster& caster, const Viewpoint& viewpoint, const RayMaker& camera,
               const CastOptions& options, int x, int y, GroundTruth& truth) {
    const std::size_t pixel = truth.at(x, y);
    const int n = options.supersampling;
    glm::dvec3 sum(0);
    int met = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const auto sample =
                (std::uint64_t(pixel) * std::uint64_t(n) + std::uint64_t(j)) * std::uint64_t(n) +
                std::uint64_t(i);
            const Ray ray = camera.through(x + (i + 0.5) / n, y + (j + 0.5) / n);
            const auto hit = caster.cast(ray, viewpoint.near, viewpoint.far, sample, options.glass);
            if (!hit) continue;
            sum += glm::dvec3(hit->color);
            ++met;
        }
    }
    truth.color[pixel] = met > 0 ? glm::vec3(sum / double(met)) : glm::vec3(0);
    truth.coverage[pixel] = float(met) / float(n * n);
    const Ray ray = camera.through(x + 0.5, y + 0.5);
    const auto hit = caster.cast(ray, viewpoint.near, viewpoint.far, pixel, options.glass);
    truth.depth[pixel] = hit ? float(hit->t) : std::numeric_limits<float>::infinity();
    if (hit)
        truth.normal[pixel] =
            glm::dot(glm::dvec3(hit->normal), ray.direction) > 0 ? -hit->normal : hit->normal;
}

}  // namespace

std::vector<std::uint8_t> GroundTruth::silhouette() const {
    std::vector<std::uint8_t> mask(coverage.size());
    std::ranges::transform(coverage, mask.begin(), [](float part) { return std::uint8_t(part >= 1); });
    return mask;
}

Frame GroundTruth::frame(const std::array<std::uint8_t, 3>& background) const {
    Frame frame;
    frame.width = width;
    frame.height = height;
    frame.depth = depth;
    std::vector<std::uint8_t>& rgba = frame.rgba.own();
    rgba.resize(color.size() * 4);
    for (std::size_t pixel = 0; pixel < color.size(); ++pixel) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float value =
                color[pixel][int(c)] * 255 * coverage[pixel] + float(background[c]) * (1 - coverage[pixel]);
            rgba[4 * pixel + c] = std::uint8_t(std::clamp(value + 0.5F, 0.0F, 255.0F));
        }
        rgba[4 * pixel + 3] = 255;
    }
    return frame;
}

Expected<GroundTruth> castRays(const RayCaster& caster, const Viewpoint& viewpoint,
                               const CastOptions& options) {
    if (options.supersampling < 1 || options.supersampling > 64)
        return fail(ErrorCode::InvalidArgument, "The supersampling must be between 1 and 64.",
                    "supersampling");
    if (viewpoint.width < 1 || viewpoint.height < 1)
        return fail(ErrorCode::InvalidArgument, "The picture has no pixels.", "width");
    try {
        GroundTruth truth;
        truth.width = viewpoint.width;
        truth.height = viewpoint.height;
        const std::size_t pixels = std::size_t(viewpoint.width) * std::size_t(viewpoint.height);
        truth.color.resize(pixels);
        truth.coverage.resize(pixels);
        truth.depth.resize(pixels);
        truth.normal.resize(pixels, glm::vec3(0));
        const RayMaker camera(viewpoint, options.cloudOrigin);
        const int cores = tbb::info::default_concurrency();
        tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
        arena.execute([&] {
            tbb::parallel_for(0, viewpoint.height, [&](int y) {
                for (int x = 0; x < viewpoint.width; ++x)
                    castPixel(caster, viewpoint, camera, options, x, y, truth);
            });
        });
        return truth;
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "There is not enough memory for the picture.");
    }
}

}  // namespace scancast
