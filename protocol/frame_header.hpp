// The binary header in front of every picture on the WebSocket. PROTOCOL.md, "Frames", is its reference for
// readers.
//
// Fixed little-endian layout; a reader takes the fields it knows and skips `headerLength` bytes to the
// picture, so later versions may append fields. Pure functions; any thread. Pipeline: encode → **frame
// header** → net → client.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// How a picture is packed. A client gets nothing but JPEG unless its hello says that it can read more.
enum class Codec : std::uint8_t {
    Jpeg = 1,
    H264 =
        2,  ///< moving frames only: one access unit in Annex B, which needs those before it unless it is a key
};
inline constexpr std::array<std::string_view, 2> codecNames{"jpeg", "h264"};
/// "jpeg"; as messages name it.
constexpr std::string_view name(Codec codec) {
    return codecNames[std::size_t(codec) - 1];
}
/// Empty for a name that is none.
constexpr std::optional<Codec> codecNamed(std::string_view text) {
    for (const Codec codec : {Codec::Jpeg, Codec::H264})
        if (name(codec) == text) return codec;
    return std::nullopt;
}

struct FrameHeader {
    Codec codec = Codec::Jpeg;
    bool moving = false;   ///< drawn while views arrive, at whatever quality the wanted fps allows
    bool still = false;    ///< a step of refinement since views stopped
    bool final = false;    ///< the full-quality still; nothing follows until something changes
    bool damaged = false;  ///< of a final one: it lacks blocks that cannot be read
    bool away = false;     ///< coarser than it would be, for now: a part of the server is out of reach
    bool key = false;      ///< of video: it needs no frame before it; decoders begin here
    std::uint32_t pictureLength = 0;  ///< bytes of the picture behind the header
    std::uint64_t frameId = 0;        ///< counts a session's frames from 1; what `ack` names
    std::uint64_t seq = 0;            ///< of the `view` that this frame shows; 0 = none yet
    std::uint32_t width = 0, height = 0;
    std::uint32_t renderMicroseconds = 0, encodeMicroseconds = 0;
    bool operator==(const FrameHeader&) const = default;
};

/// Where each field lies; the one description that writer, reader and PROTOCOL.md's test share.
struct FrameHeaderField {
    std::string_view name;
    std::size_t offset, size;
};
inline constexpr std::array<FrameHeaderField, 13> frameHeaderFields{{
    {"magic", 0, 4},         // "SCFR"
    {"version", 4, 2},       // 1
    {"headerLength", 6, 2},  // 48; larger when fields are appended, as frameDepthFields are
    {"codec", 8, 1},         // 1 = JPEG, 2 = H.264
    {"flags", 9,
     1},  // bit 0 moving, 1 still, 2 final, 3 damaged, 4 away, 5 key; others 0, ignored by readers
    {"reserved", 10, 2},       // 0, ignored by readers
    {"pictureLength", 12, 4},  // bytes behind the header
    {"frameId", 16, 8},
    {"seq", 24, 8},
    {"width", 32, 4},
    {"height", 36, 4},
    {"renderMicroseconds", 40, 4},
    {"encodeMicroseconds", 44, 4},
}};
inline constexpr std::size_t frameHeaderLength = 48;
/// What follows where `hello` asked for depth: these, then `depthLength` bytes (protocol/depth/frame_depth.hpp).
inline constexpr std::array<FrameHeaderField, 5> frameDepthFields{{
    {"depthWidth", 48, 2},
    {"depthHeight", 50, 2},
    {"depthLength", 52, 4},  // bytes at 64; 0 = the frame has no depth
    {"depthNear", 56, 4},    // float32
    {"depthFar", 60, 4},
}};
inline constexpr std::size_t frameDepthLength = 16;
inline constexpr std::uint16_t frameHeaderVersion = 1;

/// The 48 bytes that go in front of the picture, and of `appended` bytes before it: at most 65487.
std::array<std::uint8_t, frameHeaderLength> printFrameHeader(const FrameHeader& header,
                                                             std::size_t appended = 0);

/// One received message, taken apart.
struct ParsedFrame {
    FrameHeader header;
    std::span<const std::uint8_t> picture;  ///< inside the message that was parsed
    /// Where it has it, else empty: the fields and all that is packed, as unpackDepth() takes it; inside the message.
    std::span<const std::uint8_t> packedDepth{};
};

/// Truncated when bytes are missing; Malformed for another magic, sides outside 1–16384, a header length
/// below 48, depth beyond the header, or bytes behind the picture; Unsupported for an unknown version or codec.
Expected<ParsedFrame> parseFrame(std::span<const std::uint8_t> message);

}  // namespace scancast
