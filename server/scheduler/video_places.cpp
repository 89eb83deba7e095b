#include "server/scheduler/video_places.hpp"

#include <fmt/format.h>

#include <utility>

#include "video/openh264.hpp"

namespace scancast {

VideoPlaces::VideoPlaces(std::size_t most, TransientMemory memory)
    : most_(most), memory_(std::move(memory)) {}

std::vector<Codec> VideoPlaces::codecs() const {
    if (most_ > 0 && openH264()) return {Codec::H264, Codec::Jpeg};
    return {Codec::Jpeg};
}

std::string VideoPlaces::text() const {
    if (most_ == 0) return "no video: --video-sessions is 0";
    const auto library = openH264();
    if (!library) return library.error().message;
    return fmt::format("H.264 by OpenH264 {}, for {} session{} at a time", (*library)->version, most_,
                       most_ == 1 ? "" : "s");
}

Expected<std::shared_ptr<VideoStream>> VideoPlaces::take() const {
    if (most_ == 0)
        return fail(ErrorCode::Unavailable, "This server is set up without video (--video-sessions 0).");
    if (!openH264())
        return fail(ErrorCode::Unavailable, "This server has no H.264 encoder; its log says why.");
    if (taken_->fetch_add(1) >= most_) {
        taken_->fetch_sub(1);
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("All {} of this server's places for video are taken.", most_));
    }
    const std::shared_ptr<const void> place(taken_.get(),
                                            [taken = taken_](const void*) { taken->fetch_sub(1); });
    return std::make_shared<VideoStream>(memory_, place);
}

}  // namespace scancast
