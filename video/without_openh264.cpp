// In place of the rest of this room, where the headers of OpenH264 were not there when the program was built.
#include "video/openh264.hpp"
#include "video/video_decoder.hpp"
#include "video/video_encoder.hpp"

namespace scancast {
namespace {

tl::unexpected<Error> builtWithout() {
    return fail(ErrorCode::Unavailable,
                "no H.264: this program was built without libopenh264-dev, which its build needs for it");
}

}  // namespace

Expected<const OpenH264*> openH264() {
    return builtWithout();
}
bool VideoEncoder::takes(int, int) {
    return false;
}
std::uint64_t VideoEncoder::bytesFor(int, int) {
    return 0;
}
Expected<std::unique_ptr<VideoEncoder>> VideoEncoder::open(int, int) {
    return builtWithout();
}
Expected<std::unique_ptr<VideoDecoder>> VideoDecoder::open() {
    return builtWithout();
}

}  // namespace scancast
