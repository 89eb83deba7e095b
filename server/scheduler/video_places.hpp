// Which sessions may have their moving frames as video: as many as there are places, because each takes an encoder's memory, and
// who comes later gets JPEG. Who leaves gives his place back.
//
// Owned by the server. *Thread safety*: any thread; what is given out keeps what it needs.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "protocol/frame_header.hpp"
#include "server/base/transient_memory.hpp"
#include "server/scheduler/video_stream.hpp"

namespace scancast {

class VideoPlaces {
  public:
    /// `most`: 0 = none may.
    explicit VideoPlaces(std::size_t most = 0, TransientMemory memory = TransientMemory());

    /// What moving frames can be here, the best first; JPEG always.
    std::vector<Codec> codecs() const;
    /// "H.264 by OpenH264 2.3.1, for 16 sessions at a time", or why there is none: a part of a sentence, for people.
    std::string text() const;
    /// A stream for one session. Unavailable: there is no video here. ResourceLimit: all places are taken. Both with a sentence
    /// for the client.
    Expected<std::shared_ptr<VideoStream>> take() const;
    std::size_t taken() const { return *taken_; }

  private:
    const std::size_t most_;
    const TransientMemory memory_;
    const std::shared_ptr<std::atomic<std::size_t>> taken_ = std::make_shared<std::atomic<std::size_t>>(0);
};

}  // namespace scancast
