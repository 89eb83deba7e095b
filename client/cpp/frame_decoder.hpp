// A stream's frames as pixels, whichever codec each has: JPEG by itself, H.264 on top of the one before. Which a client may ask
// for, too.
//
//     hello.codecs = client::readableCodecs();       // {H264, Jpeg} where OpenH264 is installed, else {Jpeg}
//     client::FrameDecoder decoder;                   // one for each stream
//     auto pixels = decoder.decode(frame);            // every frame that comes, in turn
//
// Owned by whoever shows frames; one thread at a time.
#pragma once

#include <memory>
#include <vector>

#include "client/cpp/decode.hpp"
#include "client/cpp/stream.hpp"

namespace scancast {
class VideoDecoder;
}

namespace scancast::client {

/// For messages::Hello::codecs, the best first.
std::vector<Codec> readableCodecs();
/// Whether H.264 can be read here. Unavailable, with a sentence that says what to install.
Expected<void> canReadVideo();

class FrameDecoder {
  public:
    FrameDecoder();
    ~FrameDecoder();
    FrameDecoder(FrameDecoder&&) noexcept;
    FrameDecoder& operator=(FrameDecoder&&) noexcept;

    /// Of JPEG as decodeJpeg(). Of video: Truncated for a frame that is damaged or builds on one that did not come to this
    /// decoder, and for all that follow up to the next key, which every connection begins with; Malformed, ResourceLimit for what is no picture of the header's size, or too
    /// large; Unavailable where there is no OpenH264.
    Expected<Pixels> decode(const ReceivedFrame& frame, std::size_t mostPixels = std::size_t{16384} * 16384);

  private:
    Expected<Pixels> decodeVideo(const ReceivedFrame& frame, std::size_t mostPixels);

    std::unique_ptr<VideoDecoder> video_;
};

}  // namespace scancast::client
