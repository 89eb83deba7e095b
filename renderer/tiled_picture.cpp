#include "renderer/tiled_picture.hpp"

#include <algorithm>
#include <deque>
#include <utility>

namespace scancast {
namespace {

/// A screen of 3840 x 2160 has no more: all of it is on its way while something else is begun.
constexpr std::size_t mostUnderWay = 4;

/// Copies the part of `tile` (which covers `drawn`) that lies in `wanted` into the whole picture.
void paste(const Frame& tile, const Window& drawn, const Window& wanted, Frame& picture) {
    std::uint8_t* const rgba = picture.rgba.own().data();
    float* const depth = picture.depth.own().data();
    for (int y = 0; y < wanted.height; ++y) {
        const auto from =
            static_cast<std::size_t>(wanted.y + y - drawn.y) * static_cast<std::size_t>(drawn.width) +
            static_cast<std::size_t>(wanted.x - drawn.x);
        const auto to = static_cast<std::size_t>(wanted.y + y) * static_cast<std::size_t>(picture.width) +
                        static_cast<std::size_t>(wanted.x);
        const auto count = static_cast<std::size_t>(wanted.width);
        std::copy_n(tile.rgba.begin() + from * 4, count * 4, rgba + to * 4);
        if (!tile.depth.empty()) std::copy_n(tile.depth.begin() + from, count, depth + to);
    }
}

/// The wanted window and the margin around it that lies inside the picture.
Window withMargin(const Window& wanted, int margin, int width, int height) {
    Window drawn;
    drawn.x = std::max(0, wanted.x - margin);
    drawn.y = std::max(0, wanted.y - margin);
    drawn.width = std::min(width, wanted.x + wanted.width + margin) - drawn.x;
    drawn.height = std::min(height, wanted.y + wanted.height + margin) - drawn.y;
    return drawn;
}

/// Between tiles nothing of the device is in use, and others can be let in; within one, a GPU could lose the samples that
/// it draws to them.
bool pausesBetweenTiles(const Device& device, const Drawing& drawing) {
    return drawing.pause != nullptr && *drawing.pause && !device.info().pauses;
}

/// What a device draws at once depends on its memory, and a picture's bytes must not.
bool isOnePiece(const Device& device, const Drawing& drawing, const Tiling& tiling) {
    const Viewpoint& viewpoint = drawing.mainView().viewpoint;
    if (viewpoint.width <= tiling.side && viewpoint.height <= tiling.side) return true;
    return tiling.exact && !pausesBetweenTiles(device, drawing) &&
           std::int64_t{viewpoint.width} * viewpoint.height <= device.pixelsAtOnce();
}

class TiledPicture final : public PendingFrame {
  public:
    TiledPicture(const Viewpoint& viewpoint, bool depth) {
        picture_.width = viewpoint.width;
        picture_.height = viewpoint.height;
        const auto pixels =
            static_cast<std::size_t>(viewpoint.width) * static_cast<std::size_t>(viewpoint.height);
        picture_.rgba.own().resize(pixels * 4);
        if (depth) picture_.depth.own().resize(pixels);
    }

    Expected<void> begin(Device& device, Drawing drawing, const Tiling& tiling, const std::stop_token& stop) {
        const int width = picture_.width, height = picture_.height;
        for (int y = 0; y < height; y += tiling.side) {
            for (int x = 0; x < width; x += tiling.side) {
                if (auto ok = pasteReady(mostUnderWay - 1); !ok) return ok;
                const Window wanted{x, y, std::min(tiling.side, width - x),
                                    std::min(tiling.side, height - y)};
                drawing.window = withMargin(wanted, tiling.margin, width, height);
                auto tile = device.begin(drawing, stop);
                if (!tile) return passOn(std::move(tile));
                underWay_.push_back({std::move(*tile), drawing.window, wanted});
                if (auto ok = letOthersIn(device, drawing); !ok) return ok;
            }
        }
        // Of a device that draws at once, nothing is left.
        return pasteReady(mostUnderWay);
    }

    bool ready() override {
        return std::ranges::all_of(underWay_, [](const Tile& tile) { return tile.pixels->ready(); });
    }
    Expected<Frame> finish() override {
        while (!underWay_.empty()) {
            if (auto ok = pasteOldest(); !ok) return passOn(ok);
        }
        return std::move(picture_);
    }

  private:
    /// What is under way is finished first: pictures are finished in the order in which they were begun.
    Expected<void> letOthersIn(const Device& device, const Drawing& drawing) {
        if (!pausesBetweenTiles(device, drawing)) return {};
        if (auto ok = pasteReady(0); !ok) return ok;
        (*drawing.pause)();
        return {};
    }

    struct Tile {
        std::unique_ptr<PendingFrame> pixels;
        Window drawn, wanted;
    };

    /// What has arrived; and waits until no more than `most` are left.
    Expected<void> pasteReady(std::size_t most) {
        while (!underWay_.empty() && (underWay_.size() > most || underWay_.front().pixels->ready())) {
            if (auto ok = pasteOldest(); !ok) return ok;
        }
        return {};
    }

    Expected<void> pasteOldest() {
        const Tile tile = std::move(underWay_.front());
        underWay_.pop_front();
        const auto frame = tile.pixels->finish();
        if (!frame) return passOn(frame);
        paste(*frame, tile.drawn, tile.wanted, picture_);
        for (const StageTime& stage : frame->stats.stages) picture_.stats.add(stage.name, stage.milliseconds);
        picture_.stats.bytesUploaded += frame->stats.bytesUploaded;
        picture_.stats.deviceBytes = frame->stats.deviceBytes;
        return {};
    }

    Frame picture_;
    std::deque<Tile> underWay_;  ///< as they were begun
};

}  // namespace

Expected<std::unique_ptr<PendingFrame>> beginPicture(Device& device, const Drawing& drawing,
                                                     const Tiling& tiling, const std::stop_token& stop) {
    const Viewpoint& viewpoint = drawing.mainView().viewpoint;
    if (isOnePiece(device, drawing, tiling)) {
        Drawing whole = drawing;
        whole.window = {0, 0, viewpoint.width, viewpoint.height};
        return device.begin(whole, stop);
    }
    auto picture = std::make_unique<TiledPicture>(viewpoint, drawing.depth);
    if (auto ok = picture->begin(device, drawing, tiling, stop); !ok) return passOn(ok);
    return picture;
}

}  // namespace scancast
