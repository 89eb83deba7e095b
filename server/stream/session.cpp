#include "server/stream/session.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/view_json.hpp"
#include "renderer/render.hpp"

namespace scancast {
namespace {

std::uint32_t microseconds(double milliseconds) {
    return std::uint32_t(
        std::clamp(milliseconds * 1000, 0.0, double(std::numeric_limits<std::uint32_t>::max())));
}

double secondsBetween(StreamSession::Time from, StreamSession::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

StreamSession::StreamSession(SessionOptions options, const StreamWorld& world, StreamPort& port,
                             Metrics& metrics, Time now)
    : options_(std::move(options)),
      world_(world),
      port_(port),
      metrics_(metrics),
      opened_(now),
      nextStats_(now) {}

// ---- messages
// -------------------------------------------------------------------------------------------------

void StreamSession::text(std::string_view message, Time now) {
    if (state_ == State::Closed) return;
    if (message.size() > maxMessageBytes) {
        close(CloseCode::MessageTooBig, "A message may be 64 KiB long.");
        return;
    }
    auto parsed = parseClientMessage(message);
    if (!parsed && parsed.error().code == ErrorCode::Malformed) {
        close(CloseCode::InvalidPayload, parsed.error().message);
        return;
    }
    if (!parsed) {
        refuse(problemOf(parsed.error()), std::nullopt);
        return;
    }
    const bool greeting = std::holds_alternative<messages::Hello>(*parsed);
    if (state_ == State::Greeting && !greeting) {
        close(CloseCode::UnsupportedData, "The first message must be hello.");
        return;
    }
    std::visit([&](const auto& known) { handle(known, now); }, *parsed);
}

void StreamSession::binary() {
    close(CloseCode::UnsupportedData, "Clients send text messages only.");
}

void StreamSession::goAway() {
    close(CloseCode::GoingAway, "The server is shutting down.");
}

void StreamSession::handle(const messages::Hello& hello, Time now) {
    if (state_ != State::Greeting) {
        refuse(problemOf(Error{ErrorCode::InvalidArgument, "This session has been greeted already.", "type"}),
               std::nullopt);
        return;
    }
    const View usual;
    auto scene = openScene(hello.cloud.empty() ? world_.defaultCloud() : hello.cloud,
                           hello.width.value_or(usual.width), hello.height.value_or(usual.height));
    if (!scene) {
        refuse(std::move(scene.error()), std::nullopt);
        return;
    }
    scene_ = std::move(*scene);
    limits_.fps = hello.fps;
    state_ = State::Open;
    nextStats_ = now + options_.statsInterval;

    messages::Welcome welcome;
    welcome.session = options_.id;
    welcome.cloud = scene_.cloudId;
    welcome.methods = world_.methodNames();
    welcome.limits.maxPixels = options_.maxPixels;
    welcome.view = toJson(scene_.view);
    port_.sendText(printMessage(welcome));
    // The view of the welcome is shown without being asked for, unless the client's own view comes first.
    viewTime_ = now;
    finalWanted_ = true;
    pump(now);
}

void StreamSession::handle(const messages::ViewChange& change, Time now) {
    auto scene = sceneAfter(change);
    if (!scene) {
        refuse(std::move(scene.error()), change.seq);
        return;
    }
    scene_ = std::move(*scene);
    viewTime_ = now;
    if (fresh_) {
        ++overtaken_;
        metrics_.frameDropped(DropReason::Overwritten);
    }
    fresh_ = true;
    finalWanted_ = true;
    // A still of the old view is worth nothing now, and in the way of what the client waits for.
    if (std::erase_if(outstanding_, [](const Order& order) { return order.final; }) > 0) port_.abandon();
    pump(now);
}

void StreamSession::handle(const messages::QualityLimits& quality, Time) {
    if (quality.fps) limits_.fps = *quality.fps;
    if (quality.minResolution) limits_.minResolution = *quality.minResolution;
    if (quality.maxDetail) limits_.maxDetail = *quality.maxDetail;
    if (quality.minQuality) limits_.minJpegQuality = *quality.minQuality;
}

void StreamSession::handle(const messages::Pick& pick, Time) {
    refuse(problemOf(Error{ErrorCode::Unsupported, "This server cannot pick points yet.", "type"}), pick.seq);
}

void StreamSession::handle(const messages::Ack& ack, Time now) {
    if (ack.frame > lastFrame_) {
        close(CloseCode::PolicyViolation, "A frame was acknowledged that was never sent.");
        return;
    }
    ackedFrame_ = std::max(ackedFrame_, ack.frame);
    pump(now);
}

void StreamSession::handle(const messages::Ping& ping, Time) {
    port_.sendText(printMessage(messages::Pong{ping.id}));
}

// ---- scene
// ----------------------------------------------------------------------------------------------------

tl::expected<StreamSession::Scene, Problem> StreamSession::openScene(const std::string& cloudId, int width,
                                                                     int height) const {
    auto cloud = world_.cloud(cloudId);
    if (!cloud) return tl::unexpected(std::move(cloud.error()));
    Scene scene;
    scene.cloudId = cloudId;
    scene.view = defaultView(**cloud, width, height);
    scene.cloud = std::move(*cloud);
    if (auto sound = checkScene(scene); !sound) return tl::unexpected(problemOf(sound.error()));
    return scene;
}

tl::expected<StreamSession::Scene, Problem> StreamSession::sceneAfter(
    const messages::ViewChange& change) const {
    Scene scene = scene_;
    if (change.cloud && *change.cloud != scene_.cloudId) {
        auto opened = openScene(*change.cloud, scene_.view.width, scene_.view.height);
        if (!opened) return tl::unexpected(std::move(opened.error()));
        scene = std::move(*opened);
    }
    auto view = applyJson(scene.view, change.changes);
    if (!view) return tl::unexpected(problemOf(view.error()));
    scene.view = std::move(*view);
    scene.seq = change.seq;
    if (auto sound = checkScene(scene); !sound) return tl::unexpected(problemOf(sound.error()));
    return scene;
}

Expected<void> StreamSession::checkScene(const Scene& scene) const {
    const auto pixels = std::uint64_t(scene.view.width) * std::uint64_t(scene.view.height);
    if (pixels > options_.maxPixels) {
        return fail(ErrorCode::ResourceLimit,
                    "A picture of " + std::to_string(scene.view.width) + " x " +
                        std::to_string(scene.view.height) + " has " + std::to_string(pixels) +
                        " pixels; this server draws at most " + std::to_string(options_.maxPixels) + ".",
                    "width");
    }
    return world_.check(*scene.cloud, scene.view);
}

void StreamSession::refuse(Problem problem, std::optional<std::uint64_t> seq) {
    messages::ProblemReport report;
    report.seq = seq;
    report.problem = std::move(problem);
    port_.sendText(printMessage(report));
}

// ---- pictures
// -------------------------------------------------------------------------------------------------

StreamSession::Order StreamSession::nextOrder(bool final) {
    Order order;
    order.number = ++lastOrder_;
    order.seq = scene_.seq;
    order.viewTime = viewTime_;
    order.final = final;
    order.effort = effort_;
    return order;
}

PictureOrder StreamSession::pictureOf(const Order& order) const {
    PictureOrder picture;
    picture.cloud = scene_.cloud;
    picture.view = order.final
                       ? scene_.view
                       : movingView(scene_.view, world_.ownDetail(scene_.view), order.effort, limits_);
    picture.interruptible = order.final;
    return picture;
}

void StreamSession::place(const Order& order) {
    outstanding_.push_back(order);
    port_.order(order.number, pictureOf(order));
}

// Orders what is due. A frame that is sent or being made counts against the two that may be unacknowledged,
// so a finished picture can always go out at once.
void StreamSession::pump(Time now) {
    if (state_ != State::Open) return;
    const auto room = [&] {
        return unacknowledged() + outstanding_.size() < std::size_t(maxUnacknowledgedFrames);
    };
    if (fresh_ && room()) {
        fresh_ = false;
        place(nextOrder(false));
    } else if (fresh_ && !outstanding_.empty()) {
        const Order order = nextOrder(false);
        if (port_.replaceWaiting(order.number, pictureOf(order))) {
            fresh_ = false;
            ++overtaken_;
            outstanding_.back() = order;
        }
    }
    if (!fresh_ && finalWanted_ && now >= viewTime_ + options_.quiet && room()) {
        finalWanted_ = false;
        place(nextOrder(true));
    }
}

void StreamSession::pictureDone(std::uint64_t number, Expected<Picture> result, Time now) {
    const auto at = std::find_if(outstanding_.begin(), outstanding_.end(),
                                 [&](const Order& order) { return order.number == number; });
    if (state_ != State::Open || at == outstanding_.end()) return;  // replaced or abandoned meanwhile
    const Order order = *at;
    outstanding_.erase(at);
    if (result) {
        deliver(order, std::move(*result), now);
    } else if (result.error().code != ErrorCode::Cancelled) {
        refuse(problemOf(result.error()), order.seq);
    }
    pump(now);
}

void StreamSession::deliver(const Order& order, Picture picture, Time now) {
    FrameHeader header;
    header.moving = !order.final;
    header.still = order.final;
    header.final = order.final;
    header.pictureLength = std::uint32_t(picture.bytes->size());
    header.frameId = ++lastFrame_;
    header.seq = order.seq;
    header.width = std::uint32_t(picture.width);
    header.height = std::uint32_t(picture.height);
    header.renderMicroseconds = microseconds(picture.renderMs);
    header.encodeMicroseconds = microseconds(picture.encodeMs);
    port_.sendFrame(header, picture.bytes);

    metrics_.frameSent(secondsBetween(order.viewTime, now));
    sentTimes_.push_back(now);
    while (now - sentTimes_.front() > std::chrono::seconds(1)) sentTimes_.pop_front();
    if (!order.final)
        effort_ = nextEffort(order.effort, picture.renderMs, world_.ownDetail(scene_.view), limits_);
    if (now >= nextStats_) sendStats(order, picture, now);
}

void StreamSession::sendStats(const Order& order, const Picture& picture, Time now) {
    nextStats_ = now + options_.statsInterval;
    messages::Stats stats;
    stats.frame = lastFrame_;
    stats.seq = order.seq;
    stats.fps = double(sentTimes_.size());
    const double own = world_.ownDetail(scene_.view);
    stats.detail = order.final ? own : planMoving(order.effort, own, limits_).detail;
    stats.samples = picture.stats.samplesDrawn;
    stats.points = picture.stats.pointsShown;
    stats.dropped = overtaken_;
    for (const StageTime& stage : picture.stats.stages)
        stats.stages.push_back({stage.name, stage.milliseconds});
    port_.sendText(printMessage(stats));
}

// ---- time and end
// ---------------------------------------------------------------------------------------------

void StreamSession::tick(Time now) {
    if (state_ == State::Greeting && now >= opened_ + options_.helloPatience) {
        close(CloseCode::PolicyViolation, "No hello came.");
        return;
    }
    pump(now);
}

std::optional<StreamSession::Time> StreamSession::wakeAt() const {
    if (state_ == State::Greeting) return opened_ + options_.helloPatience;
    if (state_ != State::Open || !finalWanted_) return std::nullopt;
    // Without room it is an acknowledgement or a finished picture that brings the next step, not time.
    if (unacknowledged() + outstanding_.size() >= std::size_t(maxUnacknowledgedFrames)) return std::nullopt;
    return viewTime_ + options_.quiet;
}

void StreamSession::close(CloseCode code, std::string reason) {
    if (state_ == State::Closed) return;
    state_ = State::Closed;
    outstanding_.clear();
    port_.abandon();
    port_.sendText(printMessage(messages::Bye{code, reason}));
    port_.close(code, std::move(reason));
}

}  // namespace scancast
