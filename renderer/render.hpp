// From a view to a frame: the renderer's front door. Chooses the cut, lists the method's passes, hands them
// to the device, tile by tile where the picture is larger than a screen.
//
// Reads like the pipeline: check → viewpoint → select → provide → passes → draw. What touches a device is
// called on the device's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// A poster needs no more memory than a screen, and can be abandoned between tiles.
inline constexpr int largestTile = 2048;

struct RenderOptions {
    bool bruteForce = false;  ///< every leaf sample, no selection, no culling
    /// Blocks of a cloud file that are not in memory are waited for, as is what is not on the GPU; else
    /// ancestors are drawn for them, and they are requested.
    bool wait = true;
    std::uint64_t requester = 0;  ///< on whose behalf (renderer/residency/provide.hpp)
    /// Coarser nodes are chosen where there would be more samples than this: mostSamplesOn() the device that
    /// will draw. Without wait only; what waits is drawn in parts, if it must.
    std::optional<std::uint64_t> mostSamples{};
    /// Where the camera will be soon: its blocks are requested, too. Without wait only.
    std::optional<Camera> ahead{};
    /// Levels are chosen as this camera sees them, without culling, whatever the view's own camera: two
    /// pictures of one view that differ in this differ by changes of level alone. For tools and tests.
    std::optional<Camera> levelsOf{};
    /// Pictures wider or higher than this are drawn in tiles of at most this side, px, unless the device
    /// draws so many pixels at once (Device::pixelsAtOnce) and the method's bytes are the same then:
    /// pyramid's are not, which looks farther than a tile. Smaller for tests.
    int tileSide = largestTile;
    bool depth = true;  ///< the frame shall have its depth: what is only encoded comes sooner without
};

/// Where a client starts: the cloud's default camera, coloured by the best attribute that the cloud has.
View defaultView(const Cloud& cloud, int width = 1280, int height = 720);

/// All the checks of render() that need no device and no time: for servers that answer 400 before queueing.
/// Errors: those of validate(); NotFound for a method; InvalidArgument for its parameters, colour map, range;
/// Unsupported when the cloud lacks what the style needs.
Expected<void> checkView(const Cloud& cloud, const View& view);

/// A view of a cloud with everything decided, and the samples that it draws in memory: they stay there as
/// long as this lives. The cloud must outlive it. Immutable.
struct PreparedView;

/// The part of render() that needs no device. From any thread; with options.wait it may take as long as
/// loading does. Errors: those of checkView(); Cancelled; ResourceLimit when brute force would exceed the
/// memory limit.
Expected<std::shared_ptr<const PreparedView>> prepare(const Cloud& cloud, const View& view,
                                                      const RenderOptions& options = {},
                                                      std::stop_token stop = {});
/// Drawn by ancestors, for now: 0 after waiting.
std::uint64_t samplesMissing(const PreparedView& prepared);

/// Samples of a picture that is drawn within a frame: what the device's own memory holds at once, and room
/// for what comes next. nullopt: as many as there are.
std::optional<std::uint64_t> mostSamplesOn(Device& device);

/// What of a picture's samples is moved to a device that has memory of its own.
enum class Uploads : std::uint8_t {
    Everything,  ///< however long that takes
    ForAFrame,  ///< within its budget for a frame: for the rest ancestors are drawn, and it counts as missing
};

/// The rest of render(). Errors: the device's.
Expected<Frame> draw(Device& device, const PreparedView& prepared, std::stop_token stop = {},
                     Uploads uploads = Uploads::Everything);
/// The same in two steps (Device::begin); `prepared` is not needed afterwards. Pictures of several tiles are
/// drawn at once.
Expected<std::unique_ptr<PendingFrame>> beginDrawing(Device& device, const PreparedView& prepared,
                                                     std::stop_token stop = {},
                                                     Uploads uploads = Uploads::Everything);

/// Draws the view at the quality it names (nullopt in `quality` = full: method's own τ, no budget, 4
/// samples). With wait, the same cloud, view, device and memory limit give the same bytes, always. Errors:
/// those of checkView() and of the device.
Expected<Frame> render(Device& device, const Cloud& cloud, const View& view,
                       const RenderOptions& options = {}, std::stop_token stop = {});

}  // namespace scancast
