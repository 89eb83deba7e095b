// What is asked of the scheduler, and what it hands back: one encoded picture of one view.
// Plain values; an order shares its cloud, a picture shares its bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "protocol/view.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"
#include "renderer/image/encode.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

enum class PictureFormat : std::uint8_t { Jpeg, Png };

struct PictureOrder {
    std::shared_ptr<const Cloud> cloud;
    View view;  ///< complete: what it says is drawn
    PictureFormat format = PictureFormat::Jpeg;
    /// A newer wish of the same session stops it while it renders: for stills. A moving frame is finished,
    /// because a hand that never rests would otherwise never see one.
    bool interruptible = false;
};

struct Picture {
    std::shared_ptr<const Bytes> bytes;
    int width = 0, height = 0;
    FrameStats stats;  ///< with "encode" as the last stage
    double renderMs = 0, encodeMs = 0;
};

/// Called exactly once for each order, on a thread of the scheduler's or inside the call that made the order
/// moot; must only post. Errors: the renderer's; Cancelled; DeadlineExceeded.
using PictureDone = std::function<void(Expected<Picture>)>;

/// Draws on the render thread, which also made it and destroys it.
struct Painter {
    DeviceInfo device;
    std::function<Expected<Frame>(const Cloud&, const View&, std::stop_token)> paint;
};
using OpenPainter = std::function<Expected<Painter>()>;

/// The frame's bytes as the view and the format ask. A pure function.
Expected<Bytes> encodePicture(const Frame& frame, const View& view, PictureFormat format);

/// Paints with a real device (renderer/render.hpp).
OpenPainter devicePainter(const DeviceOptions& options);

}  // namespace scancast
