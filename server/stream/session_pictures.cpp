// Which pictures a stream session orders, and when, and how it sends them.
#include <algorithm>
#include <limits>
#include <utility>

#include "renderer/residency/motion.hpp"
#include "server/stream/session.hpp"

namespace scancast {
namespace {

std::uint32_t microseconds(double milliseconds) {
    return std::uint32_t(
        std::clamp(milliseconds * 1000, 0.0, double(std::numeric_limits<std::uint32_t>::max())));
}

// One is drawn while another waits for its turn, or for its encoder.
constexpr std::size_t mostInMaking = 2;
// How far prefetching looks ahead: about what a disk needs for a screenful.
constexpr double aheadSeconds = 0.3;
// How long a session goes without a look at whether the one that it follows still makes a picture.
constexpr std::chrono::milliseconds lookAgain{1000};

double secondsBetween(StreamSession::Time from, StreamSession::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

StreamSession::Order StreamSession::nextOrder(std::optional<StillSchedule::Still> still) {
    Order order;
    order.number = ++lastOrder_;
    order.seq = scene_.seq;
    order.viewTime = viewTime_;
    order.wanted = scene_.view;
    order.cloud = scene_.cloud;
    order.still = still;
    if (!still) {
        order.asVideo = drawsVideo();
        order.quality = quality_.choose(scene_.view, world_.ownDetail(scene_.view), limits_,
                                        order.asVideo && !jpegInstead_);
    }
    order.view = viewOf(order);
    return order;
}

View StreamSession::viewOf(const Order& order) const {
    if (!order.still) return movingView(scene_.view, order.quality);
    View view = scene_.view;
    if (order.still == StillSchedule::Still::Sharper) view.quality.samples = 1;
    return view;
}

PictureOrder StreamSession::pictureOf(const Order& order) const {
    PictureOrder picture;
    picture.cloud = scene_.cloud;
    picture.view = order.view;
    picture.planned = scene_.planned;
    picture.withDepth = withDepth_;
    picture.complete = order.still == StillSchedule::Still::Final;
    picture.onlyWhole = order.still == StillSchedule::Still::Trial;
    picture.interruptible = order.still.has_value();
    if (order.asVideo) picture.video = video_;
    if (!order.still && before_) {
        picture.ahead =
            extrapolate(*before_, scene_.view.camera, secondsBetween(beforeTime_, viewTime_), aheadSeconds);
    }
    return picture;
}

void StreamSession::place(Order order, Time now) {
    order.placed = now;
    outstanding_.push_back(order);
    port_.order(order.number, pictureOf(order));
}

bool StreamSession::stillComing() const {
    return std::ranges::any_of(outstanding_, isStill);
}

// A frame that is being made counts, too, so a finished picture can always go out at once.
bool StreamSession::hasRoom(Time now) const {
    return outstanding_.size() < mostInMaking &&
           unacknowledged() + outstanding_.size() < options_.window.value_or(window_.frames(now));
}

bool StreamSession::hasQuiet(Time now) const {
    if (unacknowledged() == 0 || !quality_.link().wantsQuiet(now)) return false;
    return unacknowledged() + outstanding_.size() >= window_.quietFrames(quality_.link().wantedQuiet(now));
}

void StreamSession::pump(Time now) {
    if (state_ != State::Open) return;
    orderDue(now);
    noteMaking();
}

void StreamSession::orderDue(Time now) {
    lookedAt_ = now;
    quiet_ = hasQuiet(now);
    room_ = hasRoom(now);
    takeShared(now);
    if (awaits_ && fresh_ && now >= freshSince_ + patienceWithLeader()) {
        awaits_ = false;
        leaderRests_ = true;  // it is waited for again when it has sent a picture
    }
    if (fresh_ && room_ && !quiet_ && !awaits_ && pace_.allows(viewTime_, limits_.fps, now)) {
        fresh_ = false;
        pace_.begin(limits_.fps, now);
        place(nextOrder(std::nullopt), now);
    } else if (fresh_ && !outstanding_.empty()) {
        Order order = nextOrder(std::nullopt);
        if (port_.replaceWaiting(order.number, pictureOf(order))) {
            fresh_ = false;
            ++overtaken_;
            order.placed = outstanding_.back().placed;
            outstanding_.back() = order;
        }
    }
    room_ = hasRoom(now);
    if (fresh_ || !room_) return;
    if (const auto at = due(); !at || now < *at) return;
    if (const auto still = stills_.due(!outstanding_.empty(), stillComing(), now)) {
        stills_.ordered(*still);
        place(nextOrder(*still), now);
        room_ = hasRoom(now);
    }
}

void StreamSession::pictureDone(std::uint64_t number, Expected<EncodedPicture> result, Time now) {
    const auto at = std::find_if(outstanding_.begin(), outstanding_.end(),
                                 [&](const Order& order) { return order.number == number; });
    if (state_ != State::Open || at == outstanding_.end()) return;  // replaced or abandoned meanwhile
    const Order order = *at;
    outstanding_.erase(at);
    if (result && !order.still && order.number < finalOrder_) {
        // The final still, which was encoded sooner, has been sent: it is not to be covered by what it ended.
        ++overtaken_;
        metrics_.frameDropped(DropReason::Overwritten);
        if (video_) video_->wantKey();
    } else if (result && !continuesVideo(*result)) {
        // Shown anew, unless a still is under way that shows it better.
        fresh_ = fresh_ || !stillComing();
        freshSince_ = now;
    } else if (result) {
        deliver(order, std::move(*result), now);
    } else {
        const bool cancelled = result.error().code == ErrorCode::Cancelled;
        const bool isAway = result.error().code == ErrorCode::Unavailable;
        if (isAway && !order.still) {
            fresh_ = fresh_ || !stillComing();  // dropped; the view is still to be shown
            freshSince_ = now;
        } else if (isAway)
            stills_.away(now);
        else if (order.still == StillSchedule::Still::Trial && cancelled)
            stills_.lacked(now);
        else if (order.still && order.still != StillSchedule::Still::Final)
            stills_.failed();
        if (!cancelled && !isAway) refuse(problemOf(result.error()), order.seq);
    }
    pump(now);
}

void StreamSession::deliver(const Order& order, EncodedPicture picture, Time now) {
    FrameHeader header;
    header.moving = !order.still;
    header.still = order.still.has_value();
    header.final = order.still && order.still != StillSchedule::Still::Sharper;
    header.damaged = header.final && picture.stats.nodesDamaged > 0;  // nothing better will come
    header.away = picture.stats.away;
    header.codec = picture.codec;
    header.key = picture.key;
    if (header.away) stills_.saidAway();
    if (order.still) stills_.drawn(*order.still, picture.stats.samplesMissing, now);
    if (header.final) finalOrder_ = order.number;
    header.pictureLength = std::uint32_t(picture.bytes->size());
    header.frameId = ++lastFrame_;
    header.seq = order.seq;
    header.width = std::uint32_t(picture.width);
    header.height = std::uint32_t(picture.height);
    header.renderMicroseconds = microseconds(picture.renderMs);
    header.encodeMicroseconds = microseconds(picture.encodeMs);
    const double own = world_.ownDetail(scene_.view);
    if (!order.still && !order.taken) {
        quality_.drawn(order.quality, {picture.renderMs, picture.encodeMs, picture.rivals}, own, limits_);
    }
    const std::size_t depthBytes = withDepth_ && picture.depth ? picture.depth->size() : 0;
    const std::size_t bytes = picture.bytes->size() + depthBytes;
    quality_.sent(header.frameId, order.view, bytes, now, codingOf(picture));
    if (order.still)
        window_.sentStill(header.frameId, bytes, now);
    else
        window_.sentMoving(header.frameId, bytes, secondsBetween(order.placed, now), outstanding_.size(),
                           now);
    noteVideo(order, picture);
    if (options_.registration != nullptr) options_.registration->frameSent();
    remember();  // first: who gets the frame may come back at once, by another connection
    port_.sendFrame(header, picture.bytes, withDepth_ ? picture.depth : nullptr);
    noteMaking();  // first: followers that find one being made would wait for it
    share(order, picture);

    metrics_.frameSent(secondsBetween(order.viewTime, now), header.away);
    sentTimes_.push_back(now);
    while (now - sentTimes_.front() > std::chrono::seconds(1)) sentTimes_.pop_front();
    // Who looks at a picture that stays may read what it is; of those that come and go, now and then is enough.
    if (header.final || now >= nextStats_) sendStats(order, picture, now);
}

void StreamSession::sendStats(const Order& order, const EncodedPicture& picture, Time now) {
    nextStats_ = now + options_.statsInterval;
    messages::Stats stats;
    stats.frame = lastFrame_;
    stats.seq = order.seq;
    stats.fps = double(sentTimes_.size());
    const bool moving = !order.still;
    stats.detail = moving ? order.quality.detail : world_.ownDetail(scene_.view);
    stats.resolution = moving ? order.quality.resolution : 1;
    stats.jpegQuality = order.view.quality.jpegQuality;
    stats.bandwidth = quality_.link().bandwidth().value_or(0);
    stats.samples = picture.stats.samplesDrawn;
    stats.points = picture.stats.pointsShown;
    stats.dropped = overtaken_;
    stats.method = picture.stats.method;
    stats.methodReason = picture.stats.methodReason;
    stats.away = picture.stats.away;
    stats.color = picture.stats.color;
    stats.colormap = picture.stats.colormap;
    stats.range = picture.stats.colorRange;
    for (const StageTime& stage : picture.stats.stages)
        stats.stages.push_back({stage.name, stage.milliseconds});
    port_.sendText(printMessage(stats));
}

/// When the next picture is ordered: of a view that waits a moving frame, else a still. Later, where the leader's is awaited; but nobody
/// says that one which was being made came to nothing, so that is looked at now and then.
std::optional<StreamSession::Time> StreamSession::due() const {
    const Time again = lookedAt_ + lookAgain;
    if (fresh_) {
        const Time paced = pace_.due(limits_.fps);
        return awaits_ ? std::max(paced, std::min(freshSince_ + patienceWithLeader(), again)) : paced;
    }
    auto still = stills_.dueAt(!outstanding_.empty());
    if (still && awaits_) still = std::max(*still, std::min(viewTime_ + patienceWithStill(), again));
    return still;
}

}  // namespace scancast
