// From a prepared view to a frame, tile by tile where the picture is larger than a screen. Pipeline: prepare
// →
// **draw** → frame. On the device's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "renderer/prepare.hpp"

namespace scancast {

/// Samples of a picture that is drawn within a frame: what the device's own memory holds at once, and room
/// for what comes next. nullopt: as many as there are.
std::optional<std::uint64_t> mostSamplesOn(Device& device);

/// What of a picture's samples is moved to a device that has memory of its own.
enum class Uploads : std::uint8_t {
    Everything,  ///< however long that takes
    ForAFrame,  ///< within its budget for a frame: for the rest ancestors are drawn, and it counts as missing
};

/// Errors: the device's.
Expected<Frame> draw(Device& device, const PreparedView& prepared, std::stop_token stop = {},
                     Uploads uploads = Uploads::Everything);
/// The same in two steps (Device::begin); `prepared` is not needed afterwards. Pictures of several tiles are
/// drawn at once. `pause` (null = none) lets others in meanwhile: of a device that does not pause by itself
/// (DeviceInfo::pauses), between tiles.
Expected<std::unique_ptr<PendingFrame>> beginDrawing(Device& device, const PreparedView& prepared,
                                                     std::stop_token stop = {},
                                                     Uploads uploads = Uploads::Everything,
                                                     const Pause* pause = nullptr);

}  // namespace scancast
