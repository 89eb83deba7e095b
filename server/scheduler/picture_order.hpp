// What is asked of the scheduler, and what it hands back: one encoded picture of one view.
// Plain values; an order shares its cloud, a picture shares its bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "protocol/frame_header.hpp"
#include "protocol/view/view.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"
#include "renderer/image/encode.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

struct PlannedView;
struct PreparedView;
class VideoStream;

/// Depth is the frame's depth as it is: float32, little-endian, row by row from the top, +infinity =
/// background. Pixels are the frame's: red, green, blue, straight alpha, row by row from the top.
enum class PictureFormat : std::uint8_t { Jpeg, Png, Depth, Pixels };

struct PictureOrder {
    std::shared_ptr<const Cloud> cloud;
    View view;  ///< complete: what it says is drawn
    PictureFormat format = PictureFormat::Jpeg;
    bool withDepth = false;  ///< of a JPEG: its depth in cells comes with it
    /// A newer request of the same session stops it while it renders: for stills. A moving frame is finished,
    /// because a hand that never rests would otherwise never see one.
    bool interruptible = false;
    /// Everything that it draws is in memory when it is drawn, however long that takes; else ancestors stand
    /// in for what is missing, and the picture's stats say how much that is.
    bool complete = true;
    /// Of those that need not be complete: Cancelled at once, rather than drawn with something missing. What
    /// is missing has been asked for then.
    bool onlyWhole = false;
    std::optional<Camera> ahead{};  ///< where the camera will be soon
    std::uint64_t requester = 0;    ///< set by the scheduler: whose requests for blocks these are
    std::string client{};           ///< of a snapshot: whose share of the device's time it is drawn in
    double price = 0;               ///< ms that it is expected to take a core; 0 = guessed from its pixels
    /// Lives as long as the picture's bytes: a place among what its client may have and not read.
    std::shared_ptr<const void> kept{};
    /// What the view means for the cloud; of a view that differs (in its quality, mostly), what still holds
    /// is kept. Empty: not known yet. The scheduler keeps what the painter found out.
    std::shared_ptr<const PlannedView> planned{};
    /// Makes what is encoded of the frame that was drawn, beside the render thread: a map (renderer/map). Pure. Empty: the frame itself.
    std::function<Expected<Frame>(const Frame&, const std::stop_token&)> remade{};
    /// Of a JPEG that is a moving frame: encodes it, where it can, as the next picture of its session's video. Nobody else has
    /// the same bytes.
    std::shared_ptr<VideoStream> video{};
};

struct EncodedPicture {
    std::shared_ptr<const Bytes> bytes;
    std::shared_ptr<const Bytes> depth{};  ///< as packDepth() makes it, where the order is with depth
    Codec codec = Codec::Jpeg;             ///< of a stream's frame
    std::uint64_t videoNumber = 0;         ///< of a video's picture, as VideoStream counts them
    bool key = false;                      ///< of a video's picture
    int width = 0, height = 0;
    FrameStats stats;  ///< with "encode" as the last stage
    double renderMs = 0, encodeMs = 0;
    std::size_t rivals = 0;  ///< others who shared the device's time when it was begun
    DeviceInfo device;       ///< that drew it: another than when it was ordered, where that one was lost
};

/// Called exactly once for each order, on a thread of the scheduler's or inside the call that made the order
/// moot; must only post. Errors: the renderer's; Cancelled; DeadlineExceeded.
using PictureDone = std::function<void(Expected<EncodedPicture>)>;

/// An order with its samples in memory: they stay there as long as this lives.
struct PreparedPicture {
    std::shared_ptr<const PreparedView> view;  ///< the renderer's own; may be empty
    bool complete = true;
    std::shared_ptr<const PlannedView> planned{};  ///< of the order's view
};

/// From any thread, also from several at once. With `wait` the result is complete, and may take long.
using PreparePicture =
    std::function<Expected<PreparedPicture>(const PictureOrder&, bool wait, std::stop_token)>;

struct Painter;
using OpenPainter = std::function<Expected<Painter>()>;

struct Painter {
    DeviceInfo device;
    PreparePicture prepare;
    /// Draws on the render thread, which also made the painter and destroys it; what it began may outlive it.
    /// In its pauses it is called again. Unavailable - of this, or of finishing what it began -: what the picture was prepared for
    /// is not there any more; prepared again, it can be drawn.
    std::function<Expected<std::unique_ptr<PendingFrame>>(const PictureOrder&, const PreparedPicture&,
                                                          std::stop_token, const Pause&)>
        begin;
    /// Opens the one that takes over when this one's device is lost (DeviceLost); empty = none does.
    OpenPainter instead{};
};

/// The frame's bytes as the view and the format ask, the same on any number of `threads` (encodeJpeg()). A pure function, unless it is
/// stopped: Cancelled.
Expected<Bytes> encodePicture(const Frame& frame, const View& view, PictureFormat format,
                              const std::stop_token& stop = {}, int threads = 1);

/// The frame's depth in cells, packed. A pure function.
Expected<Bytes> encodeDepth(const Frame& frame);

using OpenDevice = std::function<Expected<std::unique_ptr<Device>>()>;

/// Paints with a device of the renderer's (renderer/render.hpp).
OpenPainter painterWith(OpenDevice openDevice, OpenPainter instead = {});
/// The same with what the options name; when that is lost, the cpu device takes over.
OpenPainter devicePainter(const DeviceOptions& options);

}  // namespace scancast
