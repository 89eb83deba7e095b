// Pictures that follow each other → H.264, constrained baseline: each picture one access unit of one slice in Annex B, each of
// which refers to the one before it, none to what comes later. Decoders need hold nothing back, and the SPS says so
// (max_num_reorder_frames 0). Colours are those of JPEG (BT.601, full range), 4:2:0, and the SPS says that, too.
//
// What a picture's bytes are depends on those before it: the promise of the same bytes for the same request is one of stills.
//
// Owned by whoever encodes; one thread at a time. Pipeline: frame → **video encoder** → frame header → client.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct VideoPicture {
    std::vector<std::uint8_t> bytes;
    bool key = false;  ///< IDR, with its parameter sets: decoders can begin here
};

class VideoEncoder {
  public:
    /// Of pictures of that size, px; an odd side is encoded with one more row or column, which repeats the last and which
    /// readers leave out. Unavailable where there is no OpenH264; InvalidArgument for sizes that the format has not
    /// (takes()).
    static Expected<std::unique_ptr<VideoEncoder>> open(int width, int height);
    virtual ~VideoEncoder() = default;

    /// Whether pictures of that size can be encoded: from 16 x 16 to 4096 x 2304.
    static bool takes(int width, int height);
    /// What an encoder of that size takes at most, its own copy of the picture included.
    static std::uint64_t bytesFor(int width, int height);

    virtual int width() const = 0;
    virtual int height() const = 0;
    /// `rgba`: width · height · 4 bytes, rows from the top; alpha is dropped. `quantiser` from 1 to 51, what H.264 calls QP: six
    /// more halve what is kept; any of pictures that follow each other may have another. `key` makes this one a key, as the first one is. Internal: the
    /// library refuses; pictures then go on with a key of a new encoder.
    virtual Expected<VideoPicture> encode(std::span<const std::uint8_t> rgba, int quantiser, bool key) = 0;
};

}  // namespace scancast
