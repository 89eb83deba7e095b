#include "renderer/device/plan/picture_area.hpp"

#include <algorithm>
#include <string>

namespace scancast {

Expected<void> checkDrawing(const Drawing& d) {
    const Window& w = d.window;
    if (d.cuts.empty() || d.jitter.empty())
        return fail(ErrorCode::Internal, "A drawing needs a cut and at least one frame.");
    const Viewpoint& viewpoint = d.mainView().viewpoint;
    if (w.width < 1 || w.height < 1 || w.x < 0 || w.y < 0 || w.width > viewpoint.width - w.x ||
        w.height > viewpoint.height - w.y)
        return fail(ErrorCode::InvalidArgument, "The window to draw lies outside the picture of " +
                                                    std::to_string(viewpoint.width) + " x " +
                                                    std::to_string(viewpoint.height) + " pixels.");
    if (d.jitter.size() > mostFrames)
        return fail(ErrorCode::ResourceLimit,
                    "At most " + std::to_string(mostFrames) + " frames can be averaged into one picture.");
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
        stats.nodesMissing += view.cut.nodesMissing;
        stats.samplesMissing += view.cut.samplesMissing;
        stats.nodesDamaged += view.cut.nodesDamaged;
    }
}

PictureArea pictureArea(const Drawing& drawing, const PassPlan& plan) {
    const Window& w = drawing.window;
    const Viewpoint& viewpoint = drawing.mainView().viewpoint;
    const int pad = plan.guardBand(), reach = std::max(plan.reach(), pad);
    PictureArea p;
    p.sight = {&viewpoint, pad, drawing.surfels, drawing.oriented};
    p.window = {w.x + pad, w.y + pad, w.width, w.height};
    p.area.x = std::max(0, p.window.x - reach);
    p.area.y = std::max(0, p.window.y - reach);
    p.area.width = std::min(viewpoint.width + 2 * pad, p.window.x + w.width + reach) - p.area.x;
    p.area.height = std::min(viewpoint.height + 2 * pad, p.window.y + w.height + reach) - p.area.y;
    return p;
}

}  // namespace scancast
