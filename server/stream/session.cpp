#include "server/stream/session.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/view/view_json.hpp"
#include "renderer/render.hpp"

namespace scancast {
namespace {

// Each has a picture drawn; who asks faster than it is answered gains nothing by a longer queue.
constexpr int mostPicks = 4;

bool mayLackBlocks(const Cloud& cloud) {
    return !cloud.octree.nodes().empty() && !cloud.octree.store().whole();
}

/// What is not there, or not yet, is told of elsewhere.
bool isForNow(const Error& error) {
    return error.code == ErrorCode::NotFound || error.code == ErrorCode::Unavailable;
}

}  // namespace

StreamSession::StreamSession(SessionOptions options, const StreamWorld& world, StreamPort& port,
                             Metrics& metrics, Time now)
    : options_(std::move(options)),
      world_(world),
      port_(port),
      metrics_(metrics),
      opened_(now),
      scenes_(world, options_.mayFollow ? options_.registration : nullptr, options_.maxPixels),
      id_(options_.id),
      stills_(options_.stills),
      nextStats_(now) {}

// ---- messages

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

void StreamSession::moveOn(const messages::Drain& drain) {
    if (leaving_ || state_ == State::Closed) return;
    leaving_ = drain;
    if (state_ == State::Open) port_.sendText(printMessage(drain));
}

void StreamSession::goAway() {
    close(CloseCode::GoingAway, "The server is shutting down.");
}

void StreamSession::dismiss(std::string reason) {
    close(CloseCode::PolicyViolation, std::move(reason));
}

void StreamSession::taken() {
    close(CloseCode::PolicyViolation, "Another connection continues this session.");
}

void StreamSession::connectionLost(bool done, Time now) {
    video_.reset();
    if (!ticket_) return;
    if (done)
        options_.resumable->forget(*ticket_);
    else
        options_.resumable->leave(*ticket_, now);
    ticket_.reset();
}

void StreamSession::handle(const messages::Hello& hello, Time now) {
    if (state_ != State::Greeting) {
        refuse(problemOf(Error{ErrorCode::InvalidArgument, "This session has been greeted already.", "type"}),
               std::nullopt);
        return;
    }
    withDepth_ = hello.depth;
    codecs_ = hello.codecs;
    if (auto resumed = resume(hello, now)) return begin(std::move(*resumed), true, now);
    auto scene = scenes_.opened(hello);
    if (!scene) return refuse(std::move(scene.error()), std::nullopt);
    if (!hello.follow.empty()) {
        if (auto followed = options_.registration->follow(hello.follow); !followed)
            return refuse(std::move(followed.error()), std::nullopt);
    }
    limits_.fps = hello.fps;
    begin(std::move(*scene), false, now);
}

// A session that cannot go on as it was - its time is up, its cloud is gone - begins anew. What this server does not remember,
// because another one drew it, the client says.
std::optional<Scene> StreamSession::resume(const messages::Hello& hello, Time now) {
    if (hello.resume.empty() || !options_.resumable) return std::nullopt;
    auto resumed = options_.resumable->resume(hello.resume, options_.owner, now);
    if (!resumed) return std::nullopt;
    std::optional<Scene> scene;
    if (resumed->saved) {
        scene = remembered(std::move(*resumed->saved));
    } else if (hello.view.is_object() && hello.follow.empty()) {
        if (auto said = scenes_.opened(hello)) scene = std::move(*said);
        if (scene) limits_.fps = hello.fps;
        if (scene) lastFrame_ = ackedFrame_ = hello.frame;
    }
    if (!scene) {
        options_.resumable->forget(resumed->place);
        return std::nullopt;
    }
    ticket_ = resumed->place;
    id_ = std::move(resumed->id);
    turn_ = resumed->turn + 1;
    return scene;
}

std::optional<Scene> StreamSession::remembered(SavedSession saved) {
    Scene scene{saved.cloudId, nullptr, std::move(saved.view), saved.seq};
    scene.view.with = scenes_.known(scene.view.with);
    if (!scenes_.lookAnew(scene)) return std::nullopt;
    limits_ = saved.limits;
    lastFrame_ = ackedFrame_ = saved.lastFrame;  // what was under way then is not waited for
    return scene;
}

void StreamSession::begin(Scene scene, bool resumed, Time now) {
    scene_ = std::move(scene);
    if (resumed && options_.registration != nullptr) options_.registration->resumeAs(id_);
    state_ = State::Open;
    nextStats_ = now + options_.statsInterval;
    // The view of the welcome is shown without being asked for, unless the client's own view comes first. Who
    // knows the id from the welcome can follow at once: the view stands in the register by then.
    viewChanged(now);

    messages::Welcome welcome;
    welcome.session = id_;
    welcome.resumed = resumed;
    welcome.seq = scene_.seq;
    if (options_.resumable) {
        if (auto ticket = options_.resumable->open(
                {id_, options_.owner, turn_, port_.onTaken(), ticket_.value_or(0)})) {
            ticket_ = ticket->key;
            welcome.resume = std::move(ticket->token);
        }
    }
    remember();
    welcome.cloud = scene_.cloudId;
    welcome.methods = world_.methodNames();
    welcome.limits.maxPixels = options_.maxPixels;
    welcome.view = toJson(scene_.view);
    chooseCodec(welcome);
    port_.sendText(printMessage(welcome));
    if (leaving_) port_.sendText(printMessage(*leaving_));
    followLeader(now);  // it may have moved on meanwhile
    pump(now);
}

void StreamSession::remember() {
    if (ticket_)
        options_.resumable->keep(*ticket_,
                                 {id_, scene_.cloudId, scene_.view, scene_.seq, limits_, lastFrame_});
}

void StreamSession::handle(const messages::ViewChange& change, Time now) {
    if (auto shown = this->change(change, now); !shown) refuse(std::move(shown.error()), change.seq);
}

tl::expected<SharedView, Problem> StreamSession::change(const messages::ViewChange& change, Time now) {
    if (state_ != State::Open)
        return tl::unexpected(problemOf(409, "This session shows nothing; it has not begun, or has ended."));
    auto scene = scenes_.changed(scene_, change);
    if (!scene) return passOn(std::move(scene));
    if (change.follow) {
        if (change.follow->empty()) {
            if (options_.registration != nullptr) options_.registration->unfollow();
        } else if (auto followed = options_.registration->follow(*change.follow); !followed) {
            return followed;
        }
        forgetLeader();
    }
    show(std::move(*scene), now);
    followLeader(now);  // it may have moved on meanwhile
    return SharedView{scene_.cloudId, scene_.view, scene_.seq};
}

void StreamSession::show(Scene scene, Time now) {
    before_.reset();
    if (scene.cloud == scene_.cloud) {
        before_ = scene_.view.camera;
        beforeTime_ = viewTime_;
    }
    scene_ = std::move(scene);
    if (fresh_) {
        ++overtaken_;
        metrics_.frameDropped(DropReason::Overwritten);
    } else {
        freshSince_ = now;
    }
    fresh_ = true;
    remember();
    viewChanged(now);
    pump(now);
}

// The scene is another one: everything that was made of the old one at leisure is moot.
void StreamSession::viewChanged(Time now) {
    viewTime_ = now;
    stills_.begin(mayLackBlocks(*scene_.cloud), now);
    nextLook_.reset();
    if (scenes_.loading(scene_)) nextLook_ = now + options_.cloudInterval;
    // A still of the old view is worth nothing now, and in the way of what the client waits for.
    if (std::erase_if(outstanding_, isStill) > 0) port_.abandon();
    if (options_.registration != nullptr)
        options_.registration->show({scene_.cloudId, scene_.view, scene_.seq});
}

void StreamSession::lookAround(Time now) {
    if (state_ != State::Open) return;
    const auto cloud = world_.cloud(scene_.cloudId);
    if (!cloud && cloud.error().status == 404) {
        refuse(cloud.error(), std::nullopt);
        return close(CloseCode::GoingAway,
                     "The cloud that this session showed has been removed, or cannot be read any more.");
    }
    followLeader(now);
    if (state_ != State::Open || !cloud) return;
    leaveOutLost(now);
    if (scenes_.isCurrent(scene_)) return pump(now);  // the leader may have sent a picture
    nextLook_ = now;                                  // another cloud has taken the name
    lookForNewerCloud(now);
    pump(now);
}

// Its client is told, and sees what is left.
void StreamSession::leaveOutLost(Time now) {
    Scene scene = scene_;
    scene.view.with = scenes_.known(scene_.view.with);
    if (scene.view.with == scene_.view.with) return;
    for (const ViewedCloud& one : scene_.view.with) {
        if (std::ranges::find(scene.view.with, one) != scene.view.with.end()) continue;
        Problem problem =
            problemOf(404, "The cloud \"" + one.cloud +
                               "\" has been removed, or cannot be read any more; this session shows the "
                               "others without it.");
        problem.errors.push_back({"with", problem.detail});
        refuse(std::move(problem), std::nullopt);
    }
    if (auto sound = scenes_.lookAnew(scene); !sound) return refuse(problemOf(sound.error()), std::nullopt);
    show(std::move(scene), now);
}

void StreamSession::followLeader(Time now) {
    if (!following()) return;
    auto shown = options_.registration->leader();
    if (!shown) return leaderLeft();
    leaderHasThisSize_ = shown->view.width == scene_.view.width && shown->view.height == scene_.view.height;
    auto scene = scenes_.followed(*shown, scene_.view.width, scene_.view.height);
    if (!scene) return sayNotShown(std::move(scene.error()));
    notShown_.reset();
    scene->seq = scene_.seq;
    if (scene->cloud != scene_.cloud || scene->view != scene_.view) show(std::move(*scene), now);
}

// Once, however many views of its and pictures come that are as these; numbers in the sentence may differ.
void StreamSession::sayNotShown(Problem problem) {
    const auto isSame = [&](const Problem& said) {
        return said.status == problem.status &&
               std::ranges::equal(said.errors, problem.errors, {}, &Problem::Cause::parameter,
                                  &Problem::Cause::parameter);
    };
    if (notShown_ && isSame(*notShown_)) return;
    notShown_ = problem;
    refuse(std::move(problem), std::nullopt);
}

void StreamSession::leaderLeft() {
    options_.registration->unfollow();
    forgetLeader();
    if (options_.endsWithLeader)
        return close(CloseCode::GoingAway, "The session that this one followed has ended.");
    refuse(SceneResolver::followProblem(
               404, "The session that this one followed has ended; the view stays as it is."),
           std::nullopt);
}

// A client that stands still sees a cloud get finer while it is loaded, and move while it is live.
void StreamSession::lookForNewerCloud(Time now) {
    if (state_ != State::Open || !nextLook_ || now < *nextLook_) return;
    const bool more = scenes_.loading(scene_);  // asked first: what comes after the answer is seen next time
    nextLook_.reset();
    if (more) nextLook_ = now + options_.cloudInterval;
    if (scenes_.isCurrent(scene_)) return;
    Scene scene = scene_;
    const bool isLive = scenes_.live(scene);
    const auto sound = scenes_.lookAnew(scene);
    if (scene.cloud == scene_.cloud && (sound || isForNow(sound.error()))) return;
    if (!sound) {
        // The file of a cloud was replaced, and this view cannot be shown of the new one; else one that can is to come.
        if (!more && !isLive) refuse(problemOf(sound.error()), std::nullopt);
        return;
    }
    if (isLive) return show(std::move(scene), now);
    scene_ = std::move(scene);
    before_.reset();
    viewChanged(now);
}

void StreamSession::handle(const messages::QualityLimits& quality, Time) {
    if (quality.fps) limits_.fps = *quality.fps;
    if (quality.minResolution) limits_.minResolution = *quality.minResolution;
    if (quality.maxDetail) limits_.maxDetail = *quality.maxDetail;
    if (quality.minQuality) limits_.minJpegQuality = *quality.minQuality;
    remember();
}

void StreamSession::handle(const messages::Pick& pick, Time) {
    if (picks_ >= mostPicks) {
        refuse(problemOf(429, "Wait for the answers to earlier picks before asking for more."), pick.seq);
        return;
    }
    ++picks_;
    port_.pick(pick.seq, scene_.cloud, scene_.planned, pick.x, pick.y);
}

void StreamSession::pickDone(std::uint64_t seq, Expected<nlohmann::json> point) {
    --picks_;
    if (state_ != State::Open) return;
    if (!point) return refuse(problemOf(point.error()), seq);
    port_.sendText(printMessage(messages::Picked{seq, std::move(*point)}));
}

void StreamSession::handle(const messages::Ack& ack, Time now) {
    if (ack.frame > lastFrame_) {
        close(CloseCode::PolicyViolation, "A frame was acknowledged that was never sent.");
        return;
    }
    ackedFrame_ = std::max(ackedFrame_, ack.frame);
    quality_.acknowledged(ack.frame, limits_, now);
    window_.acknowledged(ack.frame, quality_.link(), now);
    pump(now);
}

void StreamSession::handle(const messages::Ping& ping, Time) {
    port_.sendText(printMessage(messages::Pong{ping.id}));
}

void StreamSession::refuse(Problem problem, std::optional<std::uint64_t> seq) {
    messages::ProblemReport report;
    report.seq = seq;
    report.problem = std::move(problem);
    port_.sendText(printMessage(report));
}

// ---- time and end

void StreamSession::tick(Time now) {
    if (state_ == State::Greeting && now >= opened_ + options_.helloPatience) {
        close(CloseCode::PolicyViolation, "No hello came.");
        return;
    }
    lookForNewerCloud(now);
    pump(now);
}

std::optional<StreamSession::Time> StreamSession::wakeAt() const {
    if (state_ == State::Greeting) return opened_ + options_.helloPatience;
    if (state_ != State::Open) return std::nullopt;
    // Without room, or while the link is to be quiet, it is an acknowledgement or a finished picture that
    // brings the next step, not time.
    if (!room_ || (fresh_ && quiet_)) return nextLook_;
    const auto next = due();
    if (!next) return nextLook_;
    return nextLook_ ? std::min(*nextLook_, *next) : *next;
}

void StreamSession::close(CloseCode code, std::string reason) {
    if (state_ == State::Closed) return;
    state_ = State::Closed;
    if (ticket_) options_.resumable->forget(*ticket_);
    ticket_.reset();
    video_.reset();
    outstanding_.clear();
    port_.abandon();
    port_.sendText(printMessage(messages::Bye{code, reason}));
    port_.close(code, std::move(reason));
}

}  // namespace scancast
