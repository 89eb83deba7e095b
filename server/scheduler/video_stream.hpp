// One session's moving frames as a video: an encoder of its own, in which each picture builds on the one before. Which pictures
// arrived is the session's to know: it counts them by their numbers, and asks for a key where one is lacking.
//
// Shared by its session and the orders that are under way; ends with the last of them. *Thread safety*: encode() is called by
// the scheduler's encode thread, the others by any. Pipeline: scheduler → **video stream** → session.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "renderer/image/encode.hpp"
#include "renderer/image/frame.hpp"
#include "server/base/transient_memory.hpp"
#include "video/video_encoder.hpp"

namespace scancast {

/// What H.264 calls QP: that at which a moving frame is as near to what was drawn as a JPEG of that quality (1-100) is.
/// Measured, → decision 37.
int quantiserFor(int jpegQuality);

class VideoStream {
  public:
    struct Coded {
        Bytes bytes;
        std::uint64_t number = 0;  ///< counts what was encoded, from 1
        bool key = false;          ///< needs none before it
    };

    /// `place`: lives as long as this does.
    explicit VideoStream(TransientMemory memory, std::shared_ptr<const void> place = {});

    /// The next picture. Nothing: this frame cannot be one - its size, or memory, does not allow it, or the encoder failed - and is
    /// to be sent by itself, as JPEG, which the ones that follow do not mind.
    std::optional<Coded> encode(const Frame& frame, int jpegQuality);
    /// The next picture is a key: one that was encoded did not arrive, or the client begins anew.
    void wantKey() { keyWanted_ = true; }
    /// The encoder failed, and there will be no more pictures.
    bool hasFailed() const { return failed_; }

  private:
    bool prepareFor(int width, int height);

    const TransientMemory memory_;
    const std::shared_ptr<const void> place_;
    std::atomic<bool> keyWanted_{false}, failed_{false};
    std::mutex mutex_;  // guards what follows
    TransientMemory::Hold held_;
    std::unique_ptr<VideoEncoder> encoder_;
    std::uint64_t encoded_ = 0;
};

}  // namespace scancast
