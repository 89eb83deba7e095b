// What a stream session does with pictures of the session that it follows, and hands to those that follow it.
#include <algorithm>
#include <utility>

#include "server/stream/session.hpp"

namespace scancast {
namespace {

// Of what this client's line takes for a frame: what a picture has at least that the leader's line made small.
constexpr double leastOfOwn = 0.4;
// Of this client's own: what a leader's pace has at least, for its pictures to be enough.
constexpr double leastOfPace = 0.4;
// How long it goes without a picture of the leader's before it orders one: while those come, a few times their interval.
constexpr std::chrono::milliseconds leastPatience{150}, mostPatience{1000};
constexpr int intervalsOfPatience = 3;
// While one is being made. The device draws for everybody in turn, so one that is ordered later comes later; but what takes that long may be
// waited for by hundreds.
constexpr std::chrono::milliseconds whileMade{5000};

}  // namespace

// Its own would be nearly the same: of that size, no worse than this client's limits, nearly as often, and as much as its line takes, but not much
// less because the leader's takes less.
bool StreamSession::fits(const SharedPicture& shared) const {
    const View& wanted = scene_.view;
    if (shared.wanted.width != wanted.width || shared.wanted.height != wanted.height ||
        (withDepth_ && !shared.picture.depth))
        return false;
    if (shared.still) return true;
    const MovingQuality& quality = shared.quality;
    if (shared.fps < leastOfPace * limits_.fps || quality.resolution < limits_.minResolution ||
        quality.detail > std::max(limits_.maxDetail, world_.ownDetail(wanted)) ||
        quality.jpegQuality < std::min(limits_.minJpegQuality, wanted.quality.jpegQuality))
        return false;
    const auto bandwidth = quality_.link().bandwidth();
    if (!bandwidth) return !quality.byNetwork;
    const double bytes = double(shared.picture.bytes->size()), own = *bandwidth / limits_.fps;
    return bytes <= own && (!quality.byNetwork || bytes >= leastOfOwn * own);
}

StreamSession::Clock::duration StreamSession::patienceWithLeader() const {
    if (leaderMakes_) return whileMade;
    return std::clamp<Clock::duration>(intervalsOfPatience * leadersInterval_, leastPatience, mostPatience);
}

StreamSession::Clock::duration StreamSession::patienceWithStill() const {
    return leaderMakes_ ? whileMade : mostPatience;
}

// The leader sent another picture, which may be sent here.
void StreamSession::noteShared(const std::shared_ptr<const SharedPicture>& newest, Time now) {
    if (newest == seen_) return;
    if (seen_ && !seen_->still && !newest->still) leadersInterval_ = now - seenAt_;
    seen_ = newest;
    seenAt_ = now;
    leaderRests_ = false;
}

// Those who follow are told whether a picture is being made that they may send.
void StreamSession::noteMaking() {
    if (options_.registration == nullptr) return;
    const bool makes = std::ranges::any_of(outstanding_, [](const Order& order) { return !order.asVideo; });
    if (makes != makes_) options_.registration->makes(makes);
    makes_ = makes;
}

// Whoever sees the same cloud, as an object, may see a picture of it: catalogs hand it to nobody else. Where a view waits that is newer than
// those of which its own pictures are being made, it takes their place.
void StreamSession::takeShared(Time now) {
    awaits_ = leaderMakes_ = false;
    if (options_.registration == nullptr) return;
    auto [newest, makes, follows] = options_.registration->leadersPicture();
    leaderMakes_ = makes;
    if (!newest) {  // it stands still, or moves for the first time since it has been followed
        awaits_ = fresh_ && !leaderRests_ && follows && leaderHasThisSize_;
        seen_.reset();
        return shared_.reset();
    }
    const bool suits = fits(*newest), mayBeTaken = suits && newest->cloud == scene_.cloud;
    if (mayBeTaken) noteShared(newest, now);
    awaits_ = suits && leaderHasThisSize_ && !leaderRests_;
    const bool mayBeSent = unacknowledged() < options_.window.value_or(window_.frames(now));
    if (!mayBeTaken || newest == shared_ || !mayBeSent) return;
    const bool isCurrent = newest->wanted == scene_.view;
    const bool isWanted = newest->still ? isCurrent && stills_.wanted()
                                        : fresh_ && !quiet_ && pace_.allows(now, limits_.fps, now);
    if (!isWanted) return;
    abandonOwn();
    shared_ = std::move(newest);
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

// What is being made comes to nothing; a video goes on where its client's decoder is.
void StreamSession::abandonOwn() {
    if (outstanding_.empty()) return;
    if (video_ && std::ranges::any_of(outstanding_, &Order::asVideo)) video_->wantKey();
    overtaken_ += outstanding_.size();
    outstanding_.clear();
    port_.abandon();
}

// Whom it follows, if anybody, is somebody else from now on.
void StreamSession::forgetLeader() {
    notShown_.reset();
    seen_.reset();
    leadersInterval_ = {};
    leaderRests_ = false;
}

void StreamSession::share(const Order& order, const EncodedPicture& picture) {
    const bool isEverybodys = picture.codec == Codec::Jpeg && !order.taken;
    if (options_.registration == nullptr || !isEverybodys || !options_.registration->leads()) return;
    SharedPicture shared{order.cloud,   order.wanted, order.view, order.still,
                         order.quality, limits_.fps,  picture};
    options_.registration->share(std::make_shared<const SharedPicture>(std::move(shared)));
}

}  // namespace scancast
