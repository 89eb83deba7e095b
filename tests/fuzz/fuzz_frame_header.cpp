// Frames as a client receives them: whatever is accepted lies inside the message, and its header prints to
// itself; depth that is unpacked has as many cells as it says, none of them nearer than the nearest.
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "protocol/depth/frame_depth.hpp"
#include "protocol/frame_header.hpp"

namespace {

using namespace scancast;

void unpack(std::span<const std::uint8_t> packed) {
    const auto depth = unpackDepth(packed);
    if (!depth) return;
    if (depth->inverse.size() != std::size_t(depth->width) * std::size_t(depth->height)) std::abort();
    for (const float inverse : depth->inverse)
        if (inverse != 0 && !(inverse > 0 && double(inverse) * double(depth->near) < 1.000001)) std::abort();
}

/// The input as what a stream of the right length and checksum would hold, which no mutation of a seed finds.
void unpackAsCells(std::span<const std::uint8_t> data) {
    if (data.size() < frameDepthLength) return;
    std::vector<std::uint8_t> packed(data.begin(), data.begin() + frameDepthLength);
    packed[0] = std::uint8_t(1 + packed[0] % 16);
    packed[2] = std::uint8_t(1 + packed[2] % 16);
    packed[1] = packed[3] = 0;
    const std::size_t symbols = std::size_t(2) * packed[0] * packed[2];
    std::vector<std::uint8_t> cells(data.begin() + frameDepthLength, data.end());
    cells.resize(symbols);
    std::vector<std::uint8_t> stream(compressBound(uLong(cells.size())));
    uLongf length = uLongf(stream.size());
    if (compress(stream.data(), &length, cells.data(), uLong(cells.size())) != Z_OK) std::abort();
    for (std::size_t i = 0; i < 4; ++i) packed[4 + i] = std::uint8_t(length >> (8 * i));
    packed.insert(packed.end(), stream.begin(), stream.begin() + std::ptrdiff_t(length));
    unpack(packed);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    unpackAsCells({data, size});
    const auto frame = parseFrame({data, size});
    if (!frame) return 0;
    if (frame->picture.size() != frame->header.pictureLength) std::abort();
    if (!frame->picture.empty() &&
        (frame->picture.data() < data || frame->picture.data() + frame->picture.size() != data + size))
        std::abort();
    if (!frame->packedDepth.empty()) {
        if (frame->packedDepth.data() != data + frameHeaderLength ||
            frame->packedDepth.size() > size - frameHeaderLength - frame->picture.size())
            std::abort();
        unpack(frame->packedDepth);
    }
    auto header = frame->header;
    header.pictureLength = 0;
    const auto again = parseFrame(printFrameHeader(header));
    if (!again || again->header != header) std::abort();
    return 0;
}
