// Frames as a client receives them: whatever is accepted lies inside the message, and its header prints to
// itself.
#include <cstdlib>

#include "protocol/frame_header.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto frame = parseFrame({data, size});
    if (!frame) return 0;
    if (frame->picture.size() != frame->header.pictureLength) std::abort();
    if (!frame->picture.empty() &&
        (frame->picture.data() < data || frame->picture.data() + frame->picture.size() != data + size))
        std::abort();
    auto header = frame->header;
    header.pictureLength = 0;
    const auto again = parseFrame(printFrameHeader(header));
    if (!again || again->header != header) std::abort();
    return 0;
}
