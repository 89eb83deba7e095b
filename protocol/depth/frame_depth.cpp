#include "protocol/depth/frame_depth.hpp"

#include <zlib.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "protocol/depth/depth_codes.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t fieldOf(std::size_t index, std::span<const std::uint8_t> packed) {
    const FrameHeaderField& field = frameDepthFields[index];
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < field.size; ++i)
        value |= std::uint64_t{packed[field.offset - frameHeaderLength + i]} << (8 * i);
    return value;
}

void putField(std::size_t index, std::uint64_t value, std::span<std::uint8_t> packed) {
    const FrameHeaderField& field = frameDepthFields[index];
    for (std::size_t i = 0; i < field.size; ++i)
        packed[field.offset - frameHeaderLength + i] = std::uint8_t(value >> (8 * i));
}

bool isSide(int cells) {
    return cells >= 1 && cells <= mostDepthCells;
}

std::string sizeText(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

/// Codes in rows, each beside what those before it predict.
class CodedRows {
  public:
    CodedRows(int width, int height) : width_(std::size_t(width)), codes_(width_ * std::size_t(height)) {}

    int predictedAt(std::size_t i) const {
        const bool first = i % width_ == 0;
        if (i < width_) return first ? 0 : codes_[i - 1];
        const int above = codes_[i - width_];
        return first ? above : depth_codes::predicted(codes_[i - 1], above, codes_[i - width_ - 1]);
    }
    void put(std::size_t i, int code) { codes_[i] = std::uint16_t(code); }
    std::size_t size() const { return codes_.size(); }

  private:
    std::size_t width_;
    std::vector<std::uint16_t> codes_;
};

struct Range {
    float near = 0, far = 0;
};

Expected<Range> rangeOf(const DepthCells& cells) {
    Range range;
    for (const float depth : cells.depth) {
        if (!(depth > 0))
            return fail(ErrorCode::InvalidArgument, "a cell's depth is not above 0", "depth");
        if (std::isinf(depth)) continue;
        range.near = range.near > 0 ? std::min(range.near, depth) : depth;
        range.far = std::max(range.far, depth);
    }
    return range;
}

/// All low bytes, then all high ones, which are mostly the same.
std::vector<std::uint8_t> symbolsOf(const DepthCells& cells, float near) {
    CodedRows rows(cells.width, cells.height);
    std::vector<std::uint8_t> symbols(2 * rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const int predicted = rows.predictedAt(i);
        const bool background = std::isinf(cells.depth[i]);
        // Cells beside it see through background.
        const int code =
            background ? predicted : depth_codes::codeOf(double(near) / double(cells.depth[i]));
        rows.put(i, code);
        const int symbol = background ? 0 : depth_codes::symbolOf(code - predicted);
        symbols[i] = std::uint8_t(symbol & 255);
        symbols[rows.size() + i] = std::uint8_t(symbol >> 8);
    }
    return symbols;
}

/// Appends a zlib stream of `bytes`.
Expected<void> deflateTo(std::vector<std::uint8_t>& packed, std::vector<std::uint8_t> bytes) {
    constexpr int level = 6, windowBits = 15, memoryLevel = 8;
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, windowBits, memoryLevel, Z_RLE) != Z_OK)
        return fail(ErrorCode::ResourceLimit, "there is no memory to pack a frame's depth");
    const std::size_t start = packed.size();
    packed.resize(start + deflateBound(&stream, uLong(bytes.size())));
    stream.next_in = bytes.data();
    stream.avail_in = uInt(bytes.size());
    stream.next_out = packed.data() + start;
    stream.avail_out = uInt(packed.size() - start);
    const int ended = deflate(&stream, Z_FINISH);
    packed.resize(packed.size() - stream.avail_out);
    deflateEnd(&stream);
    if (ended != Z_STREAM_END) return fail(ErrorCode::Internal, "a frame's depth could not be packed");
    return {};
}

Expected<std::vector<std::uint8_t>> inflated(std::span<const std::uint8_t> packed, std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    uLongf written = uLongf(size);
    uLong read = uLong(packed.size());
    const int ended = uncompress2(bytes.data(), &written, packed.data(), &read);
    if (ended == Z_MEM_ERROR)
        return fail(ErrorCode::ResourceLimit, "there is no memory to unpack a frame's depth");
    if (ended == Z_BUF_ERROR || (ended == Z_OK && (written != size || read != packed.size())))
        return fail(ErrorCode::Malformed,
                    "the frame's depth does not unpack to the " + std::to_string(size) + " bytes of its cells",
                    "depthLength");
    if (ended != Z_OK) return fail(ErrorCode::Malformed, "the frame's depth is no zlib stream", "depthLength");
    return bytes;
}

Expected<FrameDepth> readFields(std::span<const std::uint8_t> packed) {
    if (packed.size() < frameDepthLength || packed.size() - frameDepthLength != fieldOf(2, packed))
        return fail(ErrorCode::Truncated, "the frame's depth ends early", "depthLength");
    FrameDepth depth;
    depth.width = int(fieldOf(0, packed));
    depth.height = int(fieldOf(1, packed));
    if (!isSide(depth.width) || !isSide(depth.height))
        return fail(ErrorCode::Malformed,
                    "the frame's depth has " + sizeText(depth.width, depth.height) +
                        " cells; it has 1 to 160 in each direction",
                    isSide(depth.width) ? "depthHeight" : "depthWidth");
    depth.near = std::bit_cast<float>(std::uint32_t(fieldOf(3, packed)));
    depth.far = std::bit_cast<float>(std::uint32_t(fieldOf(4, packed)));
    const bool empty = depth.near == 0 && depth.far == 0;
    if (!empty && !(depth.near > 0 && depth.near <= depth.far && std::isfinite(depth.far)))
        return fail(ErrorCode::Malformed, "the frame's depth has no range that there can be", "depthNear");
    return depth;
}

}  // namespace

Expected<std::vector<std::uint8_t>> packDepth(const DepthCells& cells) {
    if (!isSide(cells.width) || !isSide(cells.height) ||
        cells.depth.size() != std::size_t(cells.width) * std::size_t(cells.height))
        return fail(ErrorCode::InvalidArgument,
                    "a frame's depth cannot have " + sizeText(cells.width, cells.height) + " cells with " +
                        std::to_string(cells.depth.size()) + " values");
    const auto range = rangeOf(cells);
    if (!range) return passOn(range);
    std::vector<std::uint8_t> packed(frameDepthLength);
    if (auto ok = deflateTo(packed, symbolsOf(cells, range->near)); !ok) return passOn(ok);
    putField(0, std::uint64_t(cells.width), packed);
    putField(1, std::uint64_t(cells.height), packed);
    putField(2, packed.size() - frameDepthLength, packed);
    putField(3, std::bit_cast<std::uint32_t>(range->near), packed);
    putField(4, std::bit_cast<std::uint32_t>(range->far), packed);
    return packed;
}

Expected<FrameDepth> unpackDepth(std::span<const std::uint8_t> packed) {
    auto depth = readFields(packed);
    if (!depth) return depth;
    CodedRows rows(depth->width, depth->height);
    const auto symbols = inflated(packed.subspan(frameDepthLength), 2 * rows.size());
    if (!symbols) return passOn(symbols);
    depth->inverse.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const int predicted = rows.predictedAt(i);
        const int symbol = (*symbols)[i] + 256 * (*symbols)[rows.size() + i];
        const int code = symbol == 0 ? predicted : predicted + depth_codes::differenceOf(symbol);
        rows.put(i, code);
        if (symbol == 0) continue;
        if (code < 1 || code > depth_codes::nearest || depth->near == 0)
            return fail(ErrorCode::Malformed,
                        "a cell of the frame's depth lies nearer than its nearest, or nowhere", "depthNear");
        depth->inverse[i] = float(depth_codes::relativeOf(code) / double(depth->near));
    }
    return depth;
}

}  // namespace scancast
