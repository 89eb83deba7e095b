#include "renderer/device/cpu/screen_passes.hpp"

#include <algorithm>
#include <limits>

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/plan/screen_plan.hpp"
#include "renderer/image/clock.hpp"

namespace scancast::cpu {
namespace {

/// One picture's planes, and what screen passes work with.
struct Screen {
    const Sight& sight;
    const glm::dvec2& jitter;
    const Planes& planes;
    const Kernels& kernels;
    const Workers& workers;
    ScreenMemory& memory;
};

const char* run(const EyeDomePass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    const EyeDomeNumbers numbers = eyeDomeNumbers(pass);
    const int reach = numbers.reach;
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
        for (int k = 0; k < 8; ++k) e.offsets[k] = numbers.y[k] * stride + numbers.x[k];
        e.factor = numbers.factor;
        s.kernels.eyeDome(e);
    });
    return "eyedome";
}

const char* run(const PhongPass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    Phong whole;
    static_cast<PhongNumbers&>(whole) = phongNumbers(pass, s.sight, s.jitter, area.x0, area.y0);
    whole.stride = whole.width = area.width();
    whole.rgba = s.planes.rgba;
    whole.normals = s.planes.normals;
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        Phong p = whole;
        p.row0 = y0;
        p.row1 = y1;
        s.kernels.phong(p);
    });
    return "phong";
}

PyramidPlanes pyramidPlanes(const Screen& s) {
    const Rect& area = s.planes.area;
    PyramidPlanes p;
    static_cast<PyramidView&>(p) =
        pyramidView(s.sight, s.jitter, area.x0, area.y0, area.width(), area.height());
    p.rgba = s.planes.rgba;
    p.depth = s.planes.depth;
    p.stride = area.width();
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
        stats.add(name, millisecondsSince(start));
    }
}

}  // namespace scancast::cpu
