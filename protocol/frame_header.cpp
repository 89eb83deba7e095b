#include "protocol/frame_header.hpp"

#include <cassert>
#include <string>

#include "protocol/view/view.hpp"

namespace scancast {
namespace {

constexpr std::array<std::uint8_t, 4> magic{'S', 'C', 'F', 'R'};
constexpr unsigned movingBit = 1, stillBit = 2, finalBit = 4, damagedBit = 8, awayBit = 16, keyBit = 32;

/// The table in the header is what readers of other languages copy, so the code follows it too.
constexpr FrameHeaderField field(std::string_view name) {
    for (const auto& candidate : frameHeaderFields)
        if (candidate.name == name) return candidate;
    for (const auto& candidate : frameDepthFields)
        if (candidate.name == name) return candidate;
    return {};
}

consteval bool fieldsFollowEachOther() {
    std::size_t end = 0;
    for (const auto& entry : frameHeaderFields) {
        if (entry.offset != end || entry.size == 0) return false;
        end += entry.size;
    }
    if (end != frameHeaderLength) return false;
    for (const auto& entry : frameDepthFields) {
        if (entry.offset != end || entry.size == 0) return false;
        end += entry.size;
    }
    return end == frameHeaderLength + frameDepthLength;
}
static_assert(fieldsFollowEachOther());

void put(std::span<std::uint8_t> bytes, std::string_view name, std::uint64_t value) {
    const auto [unused, offset, size] = field(name);
    for (std::size_t i = 0; i < size; ++i) bytes[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

template <class T>
T get(std::span<const std::uint8_t> bytes, std::string_view name) {
    const auto [unused, offset, size] = field(name);
    assert(size <= sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes[offset + i]} << (8 * i);
    return static_cast<T>(value);
}

std::string bytesOf(std::size_t have, std::size_t wanted) {
    return std::to_string(have) + " of " + std::to_string(wanted) + " bytes";
}

Expected<void> checkStart(std::span<const std::uint8_t> message) {
    if (message.size() < frameHeaderLength)
        return fail(ErrorCode::Truncated,
                    "the frame ends inside its header: " + bytesOf(message.size(), frameHeaderLength));
    for (std::size_t i = 0; i < magic.size(); ++i)
        if (message[i] != magic[i])
            return fail(ErrorCode::Malformed, "the message does not start with SCFR, so it is no frame",
                        "magic");
    if (const auto version = get<unsigned>(message, "version"); version != frameHeaderVersion)
        return fail(ErrorCode::Unsupported,
                    "the frame has version " + std::to_string(version) + ", this program reads version 1",
                    "version");
    const auto length = get<std::size_t>(message, "headerLength");
    if (length < frameHeaderLength)
        return fail(
            ErrorCode::Malformed,
            "the frame says that its header has " + std::to_string(length) + " bytes; it has at least 48",
            "headerLength");
    if (length > message.size())
        return fail(ErrorCode::Truncated,
                    "the frame ends inside its header: " + bytesOf(message.size(), length), "headerLength");
    return {};
}

Expected<void> checkFields(const FrameHeader& header) {
    if (header.codec != Codec::Jpeg && header.codec != Codec::H264)
        return fail(ErrorCode::Unsupported,
                    "the frame has codec " + std::to_string(static_cast<int>(header.codec)) +
                        ", this program reads 1 (JPEG) and 2 (H.264)",
                    "codec");
    if (header.codec != Codec::Jpeg && !header.moving)
        return fail(
            ErrorCode::Malformed,
            "the frame is a still, and those are JPEG; its codec is " + std::string(name(header.codec)),
            "codec");
    for (const auto& [name, side] :
         {std::pair<const char*, std::uint32_t>{"width", header.width}, {"height", header.height}})
        if (side < 1 || side > static_cast<std::uint32_t>(maxPictureSide))
            return fail(ErrorCode::Malformed,
                        std::string("the frame's ") + name + " is " + std::to_string(side) +
                            " px; it must lie between 1 and 16384",
                        name);
    return {};
}

/// Of a message whose header is whole; empty where it has none.
Expected<std::span<const std::uint8_t>> packedDepthIn(std::span<const std::uint8_t> header) {
    constexpr std::size_t start = frameHeaderLength + frameDepthLength;
    if (header.size() < start) return std::span<const std::uint8_t>{};
    const auto length = get<std::size_t>(header, "depthLength");
    if (length == 0) return std::span<const std::uint8_t>{};
    if (length > header.size() - start)
        return fail(ErrorCode::Malformed,
                    "the frame's depth ends beyond its header: " + bytesOf(header.size() - start, length),
                    "depthLength");
    return header.subspan(frameHeaderLength, frameDepthLength + length);
}

}  // namespace

std::array<std::uint8_t, frameHeaderLength> printFrameHeader(const FrameHeader& header,
                                                             std::size_t appended) {
    assert(frameHeaderLength + appended <= 65535);
    std::array<std::uint8_t, frameHeaderLength> bytes{};
    for (std::size_t i = 0; i < magic.size(); ++i) bytes[i] = magic[i];
    put(bytes, "version", frameHeaderVersion);
    put(bytes, "headerLength", frameHeaderLength + appended);
    put(bytes, "codec", static_cast<std::uint64_t>(header.codec));
    put(bytes, "flags",
        (header.moving ? movingBit : 0) | (header.still ? stillBit : 0) | (header.final ? finalBit : 0) |
            (header.damaged ? damagedBit : 0) | (header.away ? awayBit : 0) | (header.key ? keyBit : 0));
    put(bytes, "pictureLength", header.pictureLength);
    put(bytes, "frameId", header.frameId);
    put(bytes, "seq", header.seq);
    put(bytes, "width", header.width);
    put(bytes, "height", header.height);
    put(bytes, "renderMicroseconds", header.renderMicroseconds);
    put(bytes, "encodeMicroseconds", header.encodeMicroseconds);
    return bytes;
}

Expected<ParsedFrame> parseFrame(std::span<const std::uint8_t> message) {
    if (auto ok = checkStart(message); !ok) return passOn(ok);
    FrameHeader header;
    header.codec = static_cast<Codec>(get<std::uint8_t>(message, "codec"));
    const auto flags = get<unsigned>(message, "flags");
    header.moving = (flags & movingBit) != 0;
    header.still = (flags & stillBit) != 0;
    header.final = (flags & finalBit) != 0;
    header.damaged = (flags & damagedBit) != 0;
    header.away = (flags & awayBit) != 0;
    header.key = (flags & keyBit) != 0;
    header.pictureLength = get<std::uint32_t>(message, "pictureLength");
    header.frameId = get<std::uint64_t>(message, "frameId");
    header.seq = get<std::uint64_t>(message, "seq");
    header.width = get<std::uint32_t>(message, "width");
    header.height = get<std::uint32_t>(message, "height");
    header.renderMicroseconds = get<std::uint32_t>(message, "renderMicroseconds");
    header.encodeMicroseconds = get<std::uint32_t>(message, "encodeMicroseconds");
    if (auto ok = checkFields(header); !ok) return passOn(ok);

    const auto headerLength = get<std::size_t>(message, "headerLength");
    const auto depth = packedDepthIn(message.first(headerLength));
    if (!depth) return passOn(depth);
    const auto picture = message.subspan(headerLength);
    if (picture.size() < header.pictureLength)
        return fail(ErrorCode::Truncated,
                    "the frame ends inside its picture: " + bytesOf(picture.size(), header.pictureLength),
                    "pictureLength");
    if (picture.size() > header.pictureLength)
        return fail(ErrorCode::Malformed,
                    "the frame has " + std::to_string(picture.size() - header.pictureLength) +
                        " bytes behind its picture",
                    "pictureLength");
    return ParsedFrame{header, picture, *depth};
}

}  // namespace scancast
