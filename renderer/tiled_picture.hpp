// Pictures that are too large for a device to draw at once: cut into tiles, which are begun one after the
// other and pasted as they arrive, so that a poster needs no more memory than a few screens and can be
// abandoned between tiles. Pipeline: prepared view → **tiles** → device → frame. On the device's thread.
#pragma once

#include <memory>
#include <stop_token>

#include "renderer/device/device.hpp"

namespace scancast {

/// How a picture is cut, where it is.
struct Tiling {
    int side = 0;       ///< of a tile, px, at most; > 0
    int margin = 0;     ///< that screen passes look at around a tile, px
    bool exact = true;  ///< nobody can tell
};

/// Begins the whole picture, whatever window `drawing` names: in one piece, if it is no larger than a tile or
/// than what the device draws at once, and nobody can tell; else tile by tile, a few of them under way at a
/// time. As Device::begin().
Expected<std::unique_ptr<PendingFrame>> beginPicture(Device& device, const Drawing& drawing,
                                                     const Tiling& tiling, const std::stop_token& stop);

}  // namespace scancast
