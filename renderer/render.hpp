// From a view to a frame: the renderer's front door. Chooses the cut, lists the method's passes, hands them
// to the device, tile by tile where the picture is larger than a screen.
//
// Reads like the pipeline: check → viewpoint → select → passes → draw. Called on the device's thread.
#pragma once

#include <memory>
#include <stop_token>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

struct RenderOptions {
    bool bruteForce = false;  ///< every leaf sample, no selection, no culling
};

/// Where a client starts: the cloud's default camera, coloured by the best attribute that the cloud has.
View defaultView(const Cloud& cloud, int width = 1280, int height = 720);

/// All the checks of render() that need no device and no time: for servers that answer 400 before queueing.
/// Errors: those of validate(); NotFound for a method; InvalidArgument for its parameters, colour map, range;
/// Unsupported when the cloud lacks what the style needs.
Expected<void> checkView(const Cloud& cloud, const View& view);

/// Draws the view at the quality it names (nullopt in `quality` = full: method's own τ, no budget, 4
/// samples). The same cloud, view and device give the same bytes, always. Errors: those of checkView() and of
/// the device.
Expected<Frame> render(Device& device, const Cloud& cloud, const View& view,
                       const RenderOptions& options = {}, std::stop_token stop = {});

}  // namespace scancast
