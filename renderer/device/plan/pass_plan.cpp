#include "renderer/device/plan/pass_plan.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {
namespace {

/// Hidden point removal finds 19 % of the hidden points near a border without it (docs/spec/pyramid.md §2).
constexpr int pyramidGuardBand = 32;

template <class P>
bool is(const Pass& pass) {
    return std::holds_alternative<P>(pass);
}

bool isScreenPass(const Pass& pass) {
    return is<PhongPass>(pass) || is<EyeDomePass>(pass) || is<HiddenPointsPass>(pass) ||
           is<PullPushPass>(pass) || is<DepthNormalsPass>(pass);
}

tl::unexpected<Error> unsupported(const char* reason) {
    return fail(ErrorCode::Unsupported, std::string("No device can draw this list of passes: ") + reason +
                                            " (renderer/device/pass.hpp).");
}

/// Empty where the passes fit each other.
const char* whatIsWrong(const PassPlan& p) {
    if (p.sum && p.sum->footprint != p.nearest.footprint)
        return "sums need the footprint of the nearest pass";
    if (p.sum && !ofSurfels(*p.sum) &&
        (p.sum->footprint != Footprint::Circle || p.nearest.profile != Profile::Flat))
        return "sums of sprites are of flat circles";
    if (p.cell && p.cell->footprint != Footprint::Disc) return "cells are of discs";
    if (p.silhouette && !ofSurfels(*p.silhouette)) return "silhouettes are of surfels";
    if (p.resolve.sums && !p.sum) return "there are no sums to resolve";
    if (p.resolve.normals && !p.bySample() && !(p.resolve.sums && p.sum->normals))
        return "normals need keys that name samples";
    if (p.resolve.normals && p.resolve.sums && !p.sum->normals) return "the sums have no normals";
    bool normals = p.resolve.normals, labelled = false, filled = false;
    for (const Pass& pass : p.screen) {
        labelled = labelled || is<HiddenPointsPass>(pass);
        if (is<PullPushPass>(pass) && !labelled) return "pull-push fills what hidden point removal labelled";
        filled = filled || is<PullPushPass>(pass);
        if (is<DepthNormalsPass>(pass) && !filled) return "normals of depth need the pyramid of pull-push";
        normals = normals || is<DepthNormalsPass>(pass);
        if (is<PhongPass>(pass) && !normals) return "lighting needs normals";
    }
    return nullptr;
}

}  // namespace

bool PassPlan::makesNormals() const {
    return std::ranges::any_of(screen, is<DepthNormalsPass>);
}

int PassPlan::reach() const {
    int reach = 0;
    for (const Pass& pass : screen) {
        if (const auto* e = std::get_if<EyeDomePass>(&pass))
            reach = std::max(reach, static_cast<int>(std::ceil(std::clamp(e->radiusPx, 0.0f, 64.0f))));
    }
    return reach;
}

int PassPlan::guardBand() const {
    const auto looksAround = [](const Pass& p) { return is<HiddenPointsPass>(p) || is<PullPushPass>(p); };
    return std::ranges::any_of(screen, looksAround) ? pyramidGuardBand : 0;
}

Expected<PassPlan> planPasses(std::span<const Pass> passes) {
    PassPlan plan;
    auto next = passes.begin();
    const auto take = [&]<class P>(std::optional<P>& into) {
        if (next != passes.end() && is<P>(*next)) into = std::get<P>(*next++);
    };
    take(plan.silhouette);
    if (next == passes.end() || !is<NearestPass>(*next)) return unsupported("it needs a nearest pass first");
    plan.nearest = std::get<NearestPass>(*next++);
    take(plan.sum);
    take(plan.cell);
    if (next == passes.end() || !is<ResolvePass>(*next))
        return unsupported("splat passes must be resolved, in the order silhouette, nearest, sum, cell");
    plan.resolve = std::get<ResolvePass>(*next++);
    for (; next != passes.end(); ++next) {
        if (!isScreenPass(*next)) return unsupported("only screen passes may follow the resolve pass");
        const auto same = [&](const Pass& p) { return p.index() == next->index(); };
        if (std::ranges::any_of(plan.screen, same)) return unsupported("it lists a screen pass twice");
        plan.screen.push_back(*next);
    }
    if (const char* wrong = whatIsWrong(plan)) return unsupported(wrong);
    return plan;
}

}  // namespace scancast
