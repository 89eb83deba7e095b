// What a stream session does with pictures of the session that it follows, and hands to those that follow it.
#include <algorithm>
#include <utility>

#include "server/stream/session.hpp"

namespace scancast {
namespace {

// Of what this client's line takes for a frame: what a picture has at least that the leader's line made small.
constexpr double leastOfOwn = 0.4;

}  // namespace

// Its own would be nearly the same: of that size, no worse than this client's limits, and as much as its line takes, but not much less because
// the leader's takes less.
bool StreamSession::fits(const SharedPicture& shared) const {
    const View& wanted = scene_.view;
    if (shared.wanted.width != wanted.width || shared.wanted.height != wanted.height ||
        (withDepth_ && !shared.picture.depth))
        return false;
    if (shared.still) return true;
    const MovingQuality& quality = shared.quality;
    if (quality.resolution < limits_.minResolution ||
        quality.detail > std::max(limits_.maxDetail, world_.ownDetail(wanted)) ||
        quality.jpegQuality < std::min(limits_.minJpegQuality, wanted.quality.jpegQuality))
        return false;
    const auto bandwidth = quality_.link().bandwidth();
    if (!bandwidth) return !quality.byNetwork;
    const double bytes = double(shared.picture.bytes->size()), own = *bandwidth / limits_.fps;
    return bytes <= own && (!quality.byNetwork || bytes >= leastOfOwn * own);
}

// Whoever sees the same cloud, as an object, may see a picture of it: catalogs hand it to nobody else. Pictures of its own that are being
// made come first, so that they keep their order.
void StreamSession::takeShared(Time now) {
    awaits_ = false;
    if (options_.registration == nullptr) return;
    auto newest = options_.registration->leadersPicture();
    if (!newest) {  // it stands still, or moves for the first time since it has been followed
        awaits_ = fresh_ && !leaderRests_ && following() && leaderHasThisSize_;
        return shared_.reset();
    }
    const bool suits = fits(*newest);
    awaits_ = suits && !leaderRests_;
    if (!suits || newest->cloud != scene_.cloud || newest == shared_ || !room_ || !outstanding_.empty())
        return;
    const bool isCurrent = newest->wanted == scene_.view;
    const bool isWanted = newest->still ? isCurrent && stills_.wanted()
                                        : fresh_ && !quiet_ && pace_.allows(now, limits_.fps, now);
    if (!isWanted) return;
    shared_ = std::move(newest);
    awaits_ = true;
    leaderRests_ = false;
    fresh_ = !isCurrent;
    freshSince_ = now;
    if (!shared_->still) pace_.begin(limits_.fps, now);
    Order order;
    order.seq = scene_.seq;
    order.viewTime = viewTime_;
    order.placed = now;
    order.still = shared_->still;
    order.quality = shared_->quality;
    order.view = shared_->drawn;
    order.taken = true;
    metrics_.frameShared();
    deliver(order, shared_->picture, now);
    room_ = hasRoom(now);
}

void StreamSession::share(const Order& order, const EncodedPicture& picture) {
    const bool isEverybodys = picture.codec == Codec::Jpeg && !order.taken;
    if (options_.registration == nullptr || !isEverybodys || !options_.registration->leads()) return;
    SharedPicture shared{order.cloud, order.wanted, order.view, order.still, order.quality, picture};
    options_.registration->share(std::make_shared<const SharedPicture>(std::move(shared)));
}

}  // namespace scancast
