#include "renderer/device/cpu/screen_passes.hpp"

#include <algorithm>
#include <limits>

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/host/screens.hpp"

namespace scancast::cpu {
namespace {

/// One picture's planes, and what screen passes work with.
struct Screen {
    const LayerView& layerView;
    const glm::dvec2& jitter;
    const Planes& planes;
    const Kernels& kernels;
    const Workers& workers;
    ScreenMemory& memory;
    const ShadowMap* sun;
};

/// What passes compare with their neighbours, made of depths row by row. Beyond the planes lies background, so that every
/// pixel has all its neighbours.
struct Surroundings {
    const float* first = nullptr;  ///< of the planes' first pixel
    int stride = 0;
};

template <class OfDepths>
Surroundings surroundings(const Screen& s, int reach, float background, const OfDepths& ofDepths) {
    const Rect& area = s.planes.area;
    const int stride = area.width() + 2 * reach, rows = area.height() + 2 * reach;
    float* const values =
        grown(s.memory.around, static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows));
    s.workers.overRows(rows, [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) {
            float* const row = values + static_cast<std::ptrdiff_t>(y) * stride;
            std::fill(row, row + stride, background);
            if (y < reach || y >= reach + area.height()) continue;
            ofDepths(s.planes.depth + static_cast<std::ptrdiff_t>(y - reach) * area.width(), row + reach,
                     area.width());
        }
    });
    return {values + static_cast<std::ptrdiff_t>(reach) * stride + reach, stride};
}

const char* run(const EyeDomePass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    const EyeDomeNumbers numbers = eyeDomeNumbers(pass);
    const Surroundings around =
        surroundings(s, numbers.reach, std::numeric_limits<float>::infinity(), s.kernels.logDepth);
    const int stride = around.stride;
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        EyeDome e;
        e.logStride = stride;
        e.logDepth = around.first + static_cast<std::ptrdiff_t>(y0) * stride;
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

const char* run(const OcclusionPass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    Occlusion whole;
    static_cast<OcclusionNumbers&>(whole) = occlusionNumbers(pass, s.layerView, s.jitter);
    const Surroundings around = surroundings(s, whole.reach, -std::numeric_limits<float>::infinity(),
                                             [&](const float* depth, float* out, int count) {
                                                 s.kernels.nearness(depth, whole.perspective, out, count);
                                             });
    whole.nearStride = around.stride;
    whole.stride = whole.width = area.width();
    for (int k = 0; k < occlusionPairs; ++k) whole.offsets[k] = whole.y[k] * around.stride + whole.x[k];
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        Occlusion o = whole;
        o.nearness = around.first + static_cast<std::ptrdiff_t>(y0) * around.stride;
        o.depth = s.planes.depth + static_cast<std::ptrdiff_t>(y0) * area.width();
        o.rgba = s.planes.rgba + static_cast<std::ptrdiff_t>(y0) * area.width();
        o.height = y1 - y0;
        s.kernels.occlude(o);
    });
    return "occlusion";
}

const char* run(const PhongPass& pass, const Screen& s) {
    const Rect& area = s.planes.area;
    Phong whole;
    static_cast<PhongNumbers&>(whole) = phongNumbers(pass, s.layerView, s.jitter, area.x0, area.y0);
    whole.stride = whole.width = area.width();
    whole.rgba = s.planes.rgba;
    whole.normals = s.planes.normals;
    if (pass.shadows && s.sun != nullptr) whole.sunSeen = s.memory.sunSeen.data();
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        Phong p = whole;
        p.row0 = y0;
        p.row1 = y1;
        s.kernels.phong(p);
    });
    return "phong";
}

/// nullptr: there is no sun.
const char* run(const ShadowPass& pass, const Screen& s) {
    if (s.sun == nullptr) return nullptr;
    const Rect& area = s.planes.area;
    Shadow whole;
    static_cast<ShadowNumbers&>(whole) =
        shadowNumbers(pass, s.layerView, *s.sun->viewpoint, s.jitter, area.x0, area.y0);
    whole.map = s.sun->depth;
    whole.stride = whole.width = area.width();
    whole.rgba = s.planes.rgba;
    whole.depths = s.planes.depth;
    whole.sunlight = grown(s.memory.sunSeen,
                           static_cast<std::size_t>(area.width()) * static_cast<std::size_t>(area.height()));
    s.workers.overRows(area.height(), [&](int y0, int y1) {
        Shadow rows = whole;
        rows.row0 = y0;
        rows.row1 = y1;
        s.kernels.shadow(rows);
    });
    return "shadow";
}

PyramidPlanes pyramidPlanes(const Screen& s) {
    const Rect& area = s.planes.area;
    PyramidPlanes p;
    static_cast<PyramidView&>(p) =
        pyramidView(s.layerView, s.jitter, area.x0, area.y0, area.width(), area.height());
    p.rgba = s.planes.rgba;
    p.depth = s.planes.depth;
    p.stride = area.width();
    return p;
}

const char* run(const HiddenPointsPass& pass, const Screen& s) {
    s.memory.pyramid.hidePoints(pyramidPlanes(s), pass, s.kernels.pyramid, s.workers);
    return "hidden points";
}

const char* run(const VisibilityPass& pass, const Screen& s) {
    s.memory.pyramid.showLabels(pyramidPlanes(s), pass, s.workers);
    return "visibility";
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

void runScreenPasses(std::span<const Pass> passes, const LayerView& layerView, const glm::dvec2& jitter,
                     const Planes& planes, const Kernels& kernels, const Workers& workers,
                     ScreenMemory& memory, FrameStats& stats, const ShadowMap* sun) {
    const Screen screen{layerView, jitter, planes, kernels, workers, memory, sun};
    for (const Pass& pass : passes) {
        if (workers.stopped()) return;
        const auto start = workers.now();
        const char* name = nullptr;
        if (const auto* phong = std::get_if<PhongPass>(&pass)) name = run(*phong, screen);
        if (const auto* shadow = std::get_if<ShadowPass>(&pass)) name = run(*shadow, screen);
        if (const auto* eyeDome = std::get_if<EyeDomePass>(&pass)) name = run(*eyeDome, screen);
        if (const auto* occlusion = std::get_if<OcclusionPass>(&pass)) name = run(*occlusion, screen);
        if (const auto* hidden = std::get_if<HiddenPointsPass>(&pass)) name = run(*hidden, screen);
        if (const auto* pullPush = std::get_if<PullPushPass>(&pass)) name = run(*pullPush, screen);
        if (const auto* normals = std::get_if<DepthNormalsPass>(&pass)) name = run(*normals, screen);
        if (const auto* visibility = std::get_if<VisibilityPass>(&pass)) name = run(*visibility, screen);
        if (name == nullptr) continue;
        stats.add(name, workers.millisecondsSince(start));
    }
}

}  // namespace scancast::cpu
