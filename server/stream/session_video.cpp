// What a stream session does with video: whether its moving frames are, and which of them may go out.
#include <utility>

#include "server/stream/session.hpp"

namespace scancast {

// Who comes back has another decoder, and so begins with a key, whatever he saw before.
void StreamSession::chooseCodec(messages::Welcome& welcome) {
    if (options_.video != nullptr) {
        welcome.codecs.clear();
        for (const Codec codec : options_.video->codecs()) welcome.codecs.emplace_back(name(codec));
    }
    if (codecs_.front() != Codec::H264) return;
    auto video = options_.video != nullptr
                     ? options_.video->take()
                     : fail(ErrorCode::Unavailable, "This connection's moving frames are JPEG always.");
    if (video) {
        video_ = std::move(*video);
        welcome.movingCodec = name(Codec::H264);
    } else {
        welcome.codecReason = std::move(video.error().message);
    }
}

// Whoever is followed has its moving frames as JPEG: a video's frames are for its own decoder, and one picture can go to all.
bool StreamSession::drawsVideo() const {
    return video_ && (options_.registration == nullptr || !options_.registration->leads());
}

// A picture of the video that builds on one which was not sent is worth nothing: then a key is to come, and the view is shown anew.
bool StreamSession::continuesVideo(const EncodedPicture& picture) {
    if (picture.codec == Codec::Jpeg || !video_) return true;
    const bool sound = picture.key || picture.videoNumber == lastVideo_ + 1;
    if (sound)
        lastVideo_ = picture.videoNumber;
    else
        video_->wantKey();
    return sound;
}

Coding StreamSession::codingOf(const EncodedPicture& picture) {
    if (picture.codec == Codec::Jpeg) return Coding::Jpeg;
    return picture.key ? Coding::VideoKey : Coding::Video;
}

// What the picture, which goes out, means for the video.
void StreamSession::noteVideo(const Order& order, const EncodedPicture& picture) {
    if (order.asVideo) jpegInstead_ = picture.codec == Codec::Jpeg;
    if (!video_) return;
    if (order.still) video_->wantKey();  // what moves next begins where nobody waits for what was before
    if (video_->hasFailed()) video_.reset();
}

}  // namespace scancast
