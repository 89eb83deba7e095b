#include "renderer/device/gl/passes/screen_passes.hpp"

#include <bit>

#include "renderer/device/host/screens.hpp"

namespace scancast::gl {
namespace {

/// One picture's planes, and what screen passes work with.
struct Screen {
    const LayerView& layerView;
    const glm::dvec2& jitter;
    const GpuPlanes& planes;
    ScreenShaders& shaders;
    Pyramid& pyramid;
    const GpuShadowMap* sun;

    PyramidView view() const {
        const ivec4& a = planes.area;
        return pyramidView(layerView, jitter, a.x, a.y, a.z, a.w);
    }
    ivec4 size() const { return {planes.area.z, planes.area.w, 0, 0}; }
};

Expected<void> run(const PhongPass& pass, const Screen& s) {
    const PhongNumbers n = phongNumbers(pass, s.layerView, s.jitter, s.planes.area.x, s.planes.area.y);
    PhongParams params{};
    params.size = s.size();
    params.size.z = n.x;
    params.size.w = n.y;
    params.eye = vec4(n.offsetX, n.offsetY, n.perspective ? n.inverseFocal : 0, 0);
    params.shares = vec4(n.ambient, n.headlight, n.sunlight, n.shine);
    params.sun = vec4(n.sun[0], n.sun[1], n.sun[2], 0);
    if (auto ok = s.shaders.set(params); !ok) return ok;
    s.planes.rgba->bindStorage(BindPlaneRgba);
    s.planes.normals->bindStorage(BindPlaneNormals);
    const bool shadows = pass.shadows && s.sun != nullptr;
    if (shadows) s.sun->seen->bindStorage(BindSunSeen);
    const Define defines[] = {{"SHADOWS", shadows ? 1 : 0}};
    return s.shaders.overPixels("light_phong.comp", params.size.x, params.size.y, defines);
}

Expected<void> run(const EyeDomePass& pass, const Screen& s) {
    const EyeDomeNumbers n = eyeDomeNumbers(pass);
    EyeDomeLight params{};
    params.size = s.size();
    for (int k = 0; k < 4; ++k)
        params.offsets[k] = ivec4(n.x[2 * k], n.y[2 * k], n.x[2 * k + 1], n.y[2 * k + 1]);
    params.strength = vec4(n.factor, 0, 0, 0);
    if (auto ok = s.shaders.set(params); !ok) return ok;
    s.planes.rgba->bindStorage(BindPlaneRgba);
    s.planes.depth->bindStorage(BindPlaneDepth);
    return s.shaders.overPixels("light_eye_dome.comp", params.size.x, params.size.y);
}

Expected<void> run(const ShadowPass& pass, const Screen& s) {
    const ShadowNumbers n =
        shadowNumbers(pass, s.layerView, *s.sun->viewpoint, s.jitter, s.planes.area.x, s.planes.area.y);
    ShadowParams params{};
    params.size = s.size();
    params.size.z = n.x;
    params.size.w = n.y;
    params.map = ivec4(n.mapWidth, n.mapHeight, n.perspective ? 1 : 0, 0);
    params.u = vec4(n.u[0], n.u[1], n.u[2], n.u[3]);
    params.v = vec4(n.v[0], n.v[1], n.v[2], n.v[3]);
    params.depth = vec4(n.depth[0], n.depth[1], n.depth[2], n.depth[3]);
    params.strength = vec4(n.strength, n.bias, n.share, 0);
    if (auto ok = s.sun->seen->reserve(s.planes.pixels() * 4); !ok) return ok;
    if (auto ok = s.shaders.set(params); !ok) return ok;
    s.planes.rgba->bindStorage(BindPlaneRgba);
    s.planes.depth->bindStorage(BindPlaneDepth);
    s.sun->depth->bindStorage(BindShadowMap);
    s.sun->seen->bindStorage(BindSunSeen);
    return s.shaders.overPixels("shadow.comp", params.size.x, params.size.y);
}

Expected<void> run(const OcclusionPass& pass, const Screen& s) {
    const OcclusionNumbers n = occlusionNumbers(pass, s.layerView, s.jitter);
    OcclusionParams params{};
    params.size = s.size();
    for (int k = 0; k < occlusionPairs; ++k)
        params.pairs[k] = ivec4(n.x[k], n.y[k], std::bit_cast<std::int32_t>(n.perPx[k]), 0);
    params.strength = vec4(n.factor, n.perspective ? 1 : 0, 0, 0);
    if (auto ok = s.shaders.set(params); !ok) return ok;
    s.planes.rgba->bindStorage(BindPlaneRgba);
    s.planes.depth->bindStorage(BindPlaneDepth);
    return s.shaders.overPixels("occlude.comp", params.size.x, params.size.y);
}

Expected<void> run(const HiddenPointsPass& pass, const Screen& s) {
    return s.pyramid.hidePoints(s.planes, s.view(), pass);
}

Expected<void> run(const VisibilityPass& pass, const Screen& s) {
    return s.pyramid.showLabels(s.planes, s.view(), pass);
}

Expected<void> run(const PullPushPass&, const Screen& s) {
    return s.pyramid.fill(s.planes, s.view());
}

Expected<void> run(const DepthNormalsPass& pass, const Screen& s) {
    return s.pyramid.findNormals(s.planes, s.view(), pass);
}

/// nullptr: not a screen pass.
const char* stageOf(const Pass& pass) {
    if (std::holds_alternative<PhongPass>(pass)) return "phong";
    if (std::holds_alternative<ShadowPass>(pass)) return "shadow";
    if (std::holds_alternative<EyeDomePass>(pass)) return "eyedome";
    if (std::holds_alternative<OcclusionPass>(pass)) return "occlusion";
    if (std::holds_alternative<HiddenPointsPass>(pass)) return "hidden points";
    if (std::holds_alternative<PullPushPass>(pass)) return "pull-push";
    if (std::holds_alternative<DepthNormalsPass>(pass)) return "normals";
    if (std::holds_alternative<VisibilityPass>(pass)) return "visibility";
    return nullptr;
}

}  // namespace

Expected<void> runScreenPasses(std::span<const Pass> passes, const LayerView& layerView,
                               const glm::dvec2& jitter, const GpuPlanes& planes, ScreenShaders& shaders,
                               Pyramid& pyramid, StageTimes& times, const std::stop_token& stop,
                               const GpuShadowMap* sun) {
    const Screen screen{layerView, jitter, planes, shaders, pyramid, sun};
    for (const Pass& pass : passes) {
        const char* const name = stageOf(pass);
        if (name == nullptr || (sun == nullptr && std::holds_alternative<ShadowPass>(pass))) continue;
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        const StageTimes::Scope timed(times, name);
        auto done = std::visit(
            [&](const auto& p) -> Expected<void> {
                if constexpr (requires { run(p, screen); }) return run(p, screen);
                return {};
            },
            pass);
        if (done) done = checkErrors(shaders.functions(), std::string("running the pass \"") + name + "\"");
        if (!done) return done;
    }
    return {};
}

}  // namespace scancast::gl
