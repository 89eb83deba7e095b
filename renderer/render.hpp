// From a view to a frame: the renderer's front door. plan → prepare → draw, each of which can also be called
// by itself. What touches a device is called on the device's thread.
#pragma once

#include "renderer/draw.hpp"

namespace scancast {

/// Draws the view at the quality it names (nullopt in `quality` = full: method's own τ, no budget, 4
/// samples). With wait, the same cloud, view, device and memory limit give the same bytes, always. Errors:
/// those of plan(), prepare() and the device.
Expected<Frame> render(Device& device, const Cloud& cloud, const View& view,
                       const RenderOptions& options = {}, std::stop_token stop = {});

}  // namespace scancast
