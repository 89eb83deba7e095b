#include "renderer/device/cpu/screen_passes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "renderer/device/cpu/grown.hpp"

namespace scancast::cpu {
namespace {

using Clock = std::chrono::steady_clock;

/// One picture's planes, and what screen passes work with.
struct Screen {
    const Sight& sight;
    const glm::dvec2& jitter;
    const Planes& planes;
    const Kernels& kernels;
    const Workers& workers;
    ScreenMemory& memory;
};

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

const char* run(const EyeDomePass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    const int reach = static_cast<int>(std::ceil(std::clamp(pass.radiusPx, 0.0f, 64.0f)));
    const int stride = area.width() + 2 * reach, rows = area.height() + 2 * reach;
    // Beyond the planes lies background, so that every pixel has eight neighbours.
    float* const logs =
        grown(s.memory.logDepth, static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows));
    s.workers.overRows(rows, [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) {
            float* const row = logs + static_cast<std::ptrdiff_t>(y) * stride;
            std::fill(row, row + stride, std::numeric_limits<float>::infinity());
            if (y < reach || y >= reach + area.height()) continue;
            s.kernels.logDepth(s.planes.depth + static_cast<std::ptrdiff_t>(y - reach) * area.width(),
                               row + reach, area.width());
        }
    });
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        EyeDome e;
        e.logStride = stride;
        e.logDepth = logs + static_cast<std::ptrdiff_t>(y0 + reach) * stride + reach;
        e.stride = e.outStride = e.width = area.width();
        e.out = s.planes.rgba + static_cast<std::ptrdiff_t>(y0) * area.width();
        e.rgba = e.out;
        e.height = y1 - y0;
        setEyeDome(pass, e);
        s.kernels.eyeDome(e);
    });
    return "eyedome";
}

const char* run(const PhongPass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    const Viewpoint& viewpoint = *s.sight.viewpoint;
    const double axisX = viewpoint.width * 0.5 + s.sight.pad + s.jitter.x;
    const double axisY = viewpoint.height * 0.5 + s.sight.pad + s.jitter.y;
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        Phong p;
        p.stride = p.width = area.width();
        p.height = y1 - y0;
        p.rgba = s.planes.rgba + static_cast<std::ptrdiff_t>(y0) * p.stride;
        p.normals = s.planes.normals + static_cast<std::ptrdiff_t>(y0) * p.stride;
        p.perspective = viewpoint.projection == Projection::Perspective;
        p.x = static_cast<float>(area.x0 + 0.5 - axisX);
        p.y = static_cast<float>(area.y0 + y0 + 0.5 - axisY);
        p.inverseFocal = static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30));
        p.ambient = pass.ambient;
        p.headlight = pass.headlight;
        p.directional = pass.directional;
        p.specular = pass.specular;
        s.kernels.phong(p);
    });
    return "phong";
}

PyramidPlanes pyramidPlanes(const Screen& s) {
    const Rect& area = s.planes.area;
    const Viewpoint& viewpoint = *s.sight.viewpoint;
    PyramidPlanes p;
    p.rgba = s.planes.rgba;
    p.depth = s.planes.depth;
    p.stride = p.width = area.width();
    p.height = area.height();
    p.perspective = viewpoint.projection == Projection::Perspective;
    p.pixelsPerUnit = viewpoint.pixelsPerUnit;
    p.center = {viewpoint.width * 0.5 + s.sight.pad + s.jitter.x - area.x0,
                viewpoint.height * 0.5 + s.sight.pad + s.jitter.y - area.y0};
    return p;
}

const char* run(const HiddenPointsPass& pass, const Screen& s) {
    s.memory.pyramid.hidePoints(pyramidPlanes(s), pass, s.kernels.pyramid, s.workers);
    return "hidden points";
}

const char* run(const PullPushPass& pass, const Screen& s) {
    s.memory.pyramid.fill(pyramidPlanes(s), pass, s.kernels.pyramid, s.workers);
    return "pull-push";
}

const char* run(const DepthNormalsPass& pass, const Screen& s) {
    s.memory.pyramid.findNormals(pyramidPlanes(s), pass, s.kernels.pyramid, s.workers, s.planes.normals,
                                 s.planes.area.width());
    return "normals";
}

}  // namespace

void runScreenPasses(std::span<const Pass> passes, const Sight& sight, const glm::dvec2& jitter,
                     const Planes& planes, const Kernels& kernels, const Workers& workers,
                     ScreenMemory& memory, FrameStats& stats) {
    const Screen screen{sight, jitter, planes, kernels, workers, memory};
    for (const Pass& pass : passes) {
        if (workers.stopped()) return;
        const auto start = Clock::now();
        const char* name = nullptr;
        if (const auto* phong = std::get_if<PhongPass>(&pass)) name = run(*phong, screen);
        if (const auto* eyeDome = std::get_if<EyeDomePass>(&pass)) name = run(*eyeDome, screen);
        if (const auto* hidden = std::get_if<HiddenPointsPass>(&pass)) name = run(*hidden, screen);
        if (const auto* pullPush = std::get_if<PullPushPass>(&pass)) name = run(*pullPush, screen);
        if (const auto* normals = std::get_if<DepthNormalsPass>(&pass)) name = run(*normals, screen);
        if (name == nullptr) continue;
        stats.add(name, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    }
}

}  // namespace scancast::cpu
