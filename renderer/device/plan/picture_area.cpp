#include "renderer/device/plan/picture_area.hpp"

#include <algorithm>
#include <string>

namespace scancast {

Expected<void> checkDrawing(const Drawing& d) {
    const Window& w = d.window;
    if (d.viewpoint == nullptr || d.cut == nullptr || d.jitter.empty())
        return fail(ErrorCode::Internal, "A drawing needs a viewpoint, a cut and at least one frame.");
    if (w.width < 1 || w.height < 1 || w.x < 0 || w.y < 0 || w.width > d.viewpoint->width - w.x ||
        w.height > d.viewpoint->height - w.y)
        return fail(ErrorCode::InvalidArgument, "The window to draw lies outside the picture of " +
                                                    std::to_string(d.viewpoint->width) + " x " +
                                                    std::to_string(d.viewpoint->height) + " pixels.");
    if (d.jitter.size() > mostFrames)
        return fail(ErrorCode::ResourceLimit,
                    "At most " + std::to_string(mostFrames) + " frames can be averaged into one picture.");
    return {};
}

PictureArea pictureArea(const Drawing& drawing, const PassPlan& plan) {
    const Window& w = drawing.window;
    const int pad = plan.guardBand(), reach = std::max(plan.reach(), pad);
    PictureArea p;
    p.sight = {drawing.viewpoint, pad, drawing.surfels, drawing.oriented};
    p.window = {w.x + pad, w.y + pad, w.width, w.height};
    p.area.x = std::max(0, p.window.x - reach);
    p.area.y = std::max(0, p.window.y - reach);
    p.area.width = std::min(drawing.viewpoint->width + 2 * pad, p.window.x + w.width + reach) - p.area.x;
    p.area.height = std::min(drawing.viewpoint->height + 2 * pad, p.window.y + w.height + reach) - p.area.y;
    return p;
}

}  // namespace scancast
