// What of a picture is drawn: the window that is asked for, and what passes look at around it. Pure
// functions. Pipeline: drawing → **picture area** → device.
#pragma once

#include "renderer/device/plan/stages.hpp"

namespace scancast {

/// Frames that can be averaged into one picture: their sums have 16 bits a channel.
inline constexpr std::size_t mostFrames = 256;

/// InvalidArgument for a window outside the picture, ResourceLimit for more frames than can be averaged.
Expected<void> checkDrawing(const Drawing& drawing);

struct PictureArea {
    Sight sight;
    /// Of the picture with its guard band, if there is one: by so much every coordinate is shifted, because
    /// devices know no negative pixels.
    Window window;
    Window area;  ///< the window, and what screen passes look at beyond it
};
/// What a frame's statistics say of its cuts, all of them together.
void tellCuts(std::span<const CutView> cuts, FrameStats& stats);

PictureArea pictureArea(const Drawing& drawing, const PassPlan& plan);

}  // namespace scancast
