#include "renderer/device/host/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "renderer/device/host/screens.hpp"

namespace scancast {
namespace {

template <class P>
bool is(const Pass& pass) {
    return std::holds_alternative<P>(pass);
}

bool isScreenPass(const Pass& pass) {
    return is<PhongPass>(pass) || is<EyeDomePass>(pass) || is<OcclusionPass>(pass) || is<ShadowPass>(pass) ||
           is<HiddenPointsPass>(pass) || is<PullPushPass>(pass) || is<DepthNormalsPass>(pass) ||
           is<VisibilityPass>(pass);
}

tl::unexpected<Error> unsupported(const char* reason) {
    return fail(ErrorCode::Unsupported, std::string("No device can draw this list of passes: ") + reason +
                                            " (renderer/device/pass.hpp).");
}

/// What shows is one paraboloid, of which the key tells which.
bool smoothable(const FramePasses& p) {
    const bool paraboloids = !ofSurfels(p.nearest) && p.nearest.footprint != Footprint::Pixel &&
                             p.nearest.profile == Profile::Paraboloid;
    return paraboloids && p.nearest.payload == Payload::Sample && !p.silhouette && !p.cell && !p.sum;
}

/// Empty where the passes fit each other.
const char* whatIsWrong(const FramePasses& p) {
    if (p.sum && p.sum->footprint != p.nearest.footprint)
        return "sums need the footprint of the nearest pass";
    if (p.sum && !ofSurfels(*p.sum) &&
        (p.sum->footprint != Footprint::Circle || p.nearest.profile != Profile::Flat))
        return "sums of sprites are of flat circles";
    if (p.cell && (p.cell->footprint != Footprint::Disc || p.nearest.footprint != Footprint::Disc))
        return "cells are of discs";
    if (p.sum && p.sum->footprint == Footprint::Disc && !p.cell)
        return "sums of discs are blended between cells";
    if (p.silhouette && !ofSurfels(*p.silhouette)) return "silhouettes are of surfels";
    if (p.resolve.sums && !p.sum) return "there are no sums to resolve";
    if (p.resolve.smooth && !smoothable(p))
        return "borders are smoothed between paraboloids whose keys name samples";
    if (p.resolve.normals && !p.bySample() && !(p.resolve.sums && p.sum->normals))
        return "normals need keys that name samples";
    if (p.resolve.normals && p.resolve.sums && !p.sum->normals) return "the sums have no normals";
    bool normals = p.resolve.normals, labelled = false, filled = false;
    for (const Pass& pass : p.screen) {
        labelled = labelled || is<HiddenPointsPass>(pass);
        if (is<PullPushPass>(pass) && !labelled) return "pull-push fills what hidden point removal labelled";
        if (is<VisibilityPass>(pass) && (!labelled || filled))
            return "labels are shown after hidden point removal, before anything is filled";
        filled = filled || is<PullPushPass>(pass);
        if (is<DepthNormalsPass>(pass) && !filled) return "normals of depth need the pyramid of pull-push";
        normals = normals || is<DepthNormalsPass>(pass);
        if (is<PhongPass>(pass) && !normals) return "lighting needs normals";
    }
    return nullptr;
}

}  // namespace

bool FramePasses::makesNormals() const {
    return std::ranges::any_of(screen, is<DepthNormalsPass>);
}

bool FramePasses::castsShadows() const {
    return std::ranges::any_of(screen, is<ShadowPass>);
}

int FramePasses::reach() const {
    int reach = resolve.smooth ? 1 : 0;
    for (const Pass& pass : screen) {
        if (const auto* e = std::get_if<EyeDomePass>(&pass))
            reach = std::max(reach, static_cast<int>(std::ceil(std::clamp(e->radiusPx, 0.0f, 64.0f))));
        if (const auto* o = std::get_if<OcclusionPass>(&pass)) reach = std::max(reach, occlusionReach(*o));
    }
    return reach;
}

int FramePasses::guardBand() const {
    const auto looksAround = [](const Pass& p) { return is<HiddenPointsPass>(p) || is<PullPushPass>(p); };
    return std::ranges::any_of(screen, looksAround) ? pyramidGuardBand : 0;
}

FramePasses shadowMapPasses(bool surfels) {
    FramePasses passes;
    passes.nearest.footprint = surfels ? Footprint::Disc : Footprint::Circle;
    passes.nearest.profile = Profile::Flat;
    passes.nearest.gain = 0;
    return passes;
}

Expected<FramePasses> framePasses(std::span<const Pass> passes) {
    FramePasses sorted;
    auto next = passes.begin();
    const auto take = [&]<class P>(std::optional<P>& into) {
        if (next != passes.end() && is<P>(*next)) into = std::get<P>(*next++);
    };
    take(sorted.silhouette);
    if (next == passes.end() || !is<NearestPass>(*next)) return unsupported("it needs a nearest pass first");
    sorted.nearest = std::get<NearestPass>(*next++);
    take(sorted.cell);
    take(sorted.sum);
    if (next == passes.end() || !is<ResolvePass>(*next))
        return unsupported("splat passes must be resolved, in the order silhouette, nearest, cell, sum");
    sorted.resolve = std::get<ResolvePass>(*next++);
    for (; next != passes.end(); ++next) {
        if (!isScreenPass(*next)) return unsupported("only screen passes may follow the resolve pass");
        const auto same = [&](const Pass& p) { return p.index() == next->index(); };
        if (std::ranges::any_of(sorted.screen, same)) return unsupported("it lists a screen pass twice");
        sorted.screen.push_back(*next);
    }
    if (const char* wrong = whatIsWrong(sorted)) return unsupported(wrong);
    return sorted;
}

Expected<void> checkDrawing(const Drawing& d) {
    const Window& w = d.window;
    if (d.cuts.empty() || d.jitter.empty())
        return fail(ErrorCode::Internal, "A drawing needs a cut and at least one frame.");
    const Viewpoint& viewpoint = d.mainView().viewpoint;
    if (w.width < 1 || w.height < 1 || w.x < 0 || w.y < 0 || w.width > viewpoint.width - w.x ||
        w.height > viewpoint.height - w.y)
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("The window to draw lies outside the picture of {} x {} pixels.",
                                viewpoint.width, viewpoint.height));
    if (d.jitter.size() > mostFrames)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("At most {} frames can be averaged into one picture.", mostFrames));
    return {};
}

void tellCuts(std::span<const CutView> cuts, FrameStats& stats) {
    stats.spacingReached = cuts.front().cut.spacingReached;
    stats.pointsShown = cuts.front().cut.points;
    stats.mirrorsDrawn = static_cast<std::uint32_t>(cuts.size() - 1);
    for (const CutView& view : cuts) {
        stats.samplesDrawn += view.cut.samples;
        stats.nodesVisited += view.cut.nodesVisited;
        stats.nodesCulled += view.cut.nodesCulled;
        stats.nodesClipped += view.cut.nodesClipped;
        stats.nodesMissing += view.cut.nodesMissing;
        stats.samplesMissing += view.cut.samplesMissing;
        stats.away = stats.away || view.cut.away;
    }
}

PictureArea pictureArea(const Drawing& drawing, const FramePasses& passes) {
    const Window& w = drawing.window;
    const Viewpoint& viewpoint = drawing.mainView().viewpoint;
    const int pad = passes.guardBand(), reach = std::max(passes.reach(), pad);
    PictureArea p;
    p.view = {&viewpoint, pad, drawing.surfels, drawing.oriented, drawing.orientedNodes, drawing.curvatures};
    p.window = {w.x + pad, w.y + pad, w.width, w.height};
    p.area.x = std::max(0, p.window.x - reach);
    p.area.y = std::max(0, p.window.y - reach);
    p.area.width = std::min(viewpoint.width + 2 * pad, p.window.x + w.width + reach) - p.area.x;
    p.area.height = std::min(viewpoint.height + 2 * pad, p.window.y + w.height + reach) - p.area.y;
    return p;
}

}  // namespace scancast
