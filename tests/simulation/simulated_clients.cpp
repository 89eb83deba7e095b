#include "tests/simulation/simulated_clients.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace scancast::simulation {
namespace {

/// Places to look from that no other client has: the same place is the same view.
double placeOf(int client, std::uint64_t view) {
    return client * 1e6 + double(view);
}

/// ms in which work for a client that has gone is to have ended.
constexpr double mostAfterwards = 100;

}  // namespace

// ---- viewers

SimulatedViewer::SimulatedViewer(int number, SimulatedServer& server, VirtualTime& time, Chance& chance,
                                 const StreamWorld& world, Metrics& metrics, const Link& link,
                                 const Hand& hand)
    : number_(number),
      server_(server),
      time_(time),
      chance_(chance),
      world_(world),
      metrics_(metrics),
      link_(link),
      hand_(hand) {
    time_.after(chance_.between(0, 1000), [this] { connect(); });
}

SimulatedViewer::~SimulatedViewer() {
    *alive_ = false;
}

// Of this connection, in an event of its own; void when another has taken its place.
void SimulatedViewer::later(std::function<void()> work) {
    time_.after(0, [this, alive = alive_, connection = connection_, work = std::move(work)] {
        if (*alive && session_ && connection == connection_) inSession(work);
    });
}

void SimulatedViewer::inSession(const std::function<void()>& work) {
    work();
    if (!session_) return;
    const auto wake = session_->wakeAt();
    if (!wake || *wake >= timer_) return;
    timer_ = *wake;
    time_.at(*wake, [this, alive = alive_, connection = connection_, at = *wake] {
        if (!*alive || timer_ != at) return;
        timer_ = Time::max();
        if (session_ && connection == connection_) inSession([this] { session_->tick(time_.now()); });
    });
}

void SimulatedViewer::connect() {
    ++connection_;
    timer_ = Time::max();
    mailbox_ = server_.openMailbox();
    SessionOptions options;
    options.id = fmt::format("viewer{}-{}", number_, connection_);
    options.maxPixels = 64'000'000;
    session_.emplace(std::move(options), world_, *this, metrics_, time_.now());
    lastMoving_.reset();
    seenFinal_ = false;
    seenSeq_ = 0;
    const nlohmann::json hello{{"type", "hello"}, {"width", hand_.width}, {"height", hand_.height}};
    inSession([&] { session_->text(hello.dump(), time_.now()); });
    move();
    if (link_.cutsPerMinute > 0)
        time_.after(60e3 / link_.cutsPerMinute * chance_.between(0.2, 1.8), [this, connection = connection_] {
            if (!calm_ && connection == connection_) disconnect();
        });
}

void SimulatedViewer::disconnect() {
    session_->connectionLost(false, time_.now());
    session_.reset();
    ++connection_;
    server_.closeMailbox(std::exchange(mailbox_, 0));
    time_.after(1000, [this] { connect(); });
}

void SimulatedViewer::move() {
    moving_ = true;
    lastMoving_.reset();
    movesUntil_ = time_.now() + milliseconds(hand_.movesMs * chance_.between(0.2, 1.8));
    sendView();
}

void SimulatedViewer::rest() {
    moving_ = false;
    time_.after(hand_.restsMs * chance_.between(0.2, 1.8), [this, connection = connection_] {
        if (!calm_ && session_ && connection == connection_) move();
    });
}

void SimulatedViewer::sendView() {
    time_.after(link_.delayMs, [this, connection = connection_, seq = ++seq_] {
        if (!session_ || connection != connection_) return;
        messages::ViewChange change;
        change.seq = seq;
        change.changes = {{"camera", {{"eye", {placeOf(number_, seq), -50, 30}}, {"target", {5, 5, 0}}}},
                          {"samples", hand_.samples}};
        inSession([&] {
            if (auto shown = session_->change(change, time_.now()); !shown)
                server_.violate("a view was refused: " + shown.error().detail);
        });
    });
    if (calm_ || time_.now() >= movesUntil_) return rest();
    time_.after(1000 / hand_.viewsPerSecond * chance_.between(0.7, 1.3), [this, connection = connection_] {
        if (session_ && connection == connection_) sendView();
    });
}

void SimulatedViewer::sendText(std::string text) {
    const auto message = nlohmann::json::parse(text);
    if (message.at("type") == "problem") server_.violate("a session was told of a problem: " + text);
}

void SimulatedViewer::close(CloseCode, std::string reason) {
    server_.violate("a session was closed: " + reason);
}

// Frames stand in line for the link, and come late where the client does not read.
void SimulatedViewer::sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                                std::shared_ptr<const Bytes>) {
    if (link_.pausesPerMinute > 0 && !calm_ && chance_.happens(link_.pausesPerMinute / 60 / 20))
        readsFrom_ = time_.now() + milliseconds(chance_.between(100, 1500));
    linkFree_ = std::max({linkFree_, time_.now(), readsFrom_}) +
                milliseconds(double(picture->size()) / link_.bytesPerMs);
    time_.at(linkFree_ + milliseconds(link_.delayMs), [this, connection = connection_, header] {
        if (session_ && connection == connection_) arrived(header);
    });
}

void SimulatedViewer::arrived(const FrameHeader& header) {
    ++frames_;
    if (header.seq < seenSeq_) server_.violate("a client was shown an older view again");
    if (header.final && header.seq == seenSeq_ && seenFinal_)
        server_.violate("a view that stood had two final stills");
    seenSeq_ = header.seq;
    seenFinal_ = header.final;
    if (header.moving && moving_) {
        if (lastMoving_) longestGap_ = std::max(longestGap_, inMilliseconds(time_.now() - *lastMoving_));
        lastMoving_ = time_.now();
    }
    time_.after(link_.delayMs, [this, connection = connection_, frame = header.frameId] {
        if (!session_ || connection != connection_) return;
        const nlohmann::json ack{{"type", "ack"}, {"frame", frame}};
        inSession([&] { session_->text(ack.dump(), time_.now()); });
    });
}

PictureDone SimulatedViewer::doneFor(std::uint64_t number) {
    return [this, number, alive = alive_, connection = connection_](Expected<EncodedPicture> result) {
        if (!*alive || connection != connection_) return;
        later([this, number, result = std::move(result)] {
            session_->pictureDone(number, result, time_.now());
        });
    };
}

// The session is inside one of its functions: what becomes of its order it is told later.
void SimulatedViewer::order(std::uint64_t number, PictureOrder order) {
    server_.request(mailbox_, std::move(order), doneFor(number));
}

bool SimulatedViewer::replaceWaiting(std::uint64_t number, PictureOrder order) {
    return server_.replaceWaiting(mailbox_, std::move(order), doneFor(number));
}

std::string SimulatedViewer::state() const {
    return fmt::format("viewer {} asked for view {}, and sees {}{}", number_, seq_, seenSeq_,
                       seenFinal_ ? ", final" : "");
}

// ---- fetchers

SimulatedFetcher::SimulatedFetcher(int number, SimulatedServer& server, VirtualTime& time, Chance& chance,
                                   std::shared_ptr<const Cloud> cloud, const Appetite& appetite)
    : number_(number),
      server_(server),
      time_(time),
      chance_(chance),
      cloud_(std::move(cloud)),
      appetite_(appetite) {
    time_.after(chance_.between(0, 2000), [this] { ask(); });
}

void SimulatedFetcher::ask() {
    if (calm_) return;
    PictureOrder order;
    order.cloud = cloud_;
    order.client = appetite_.client;
    order.view.width = appetite_.width;
    order.view.height = appetite_.height;
    order.view.quality.samples = appetite_.samples;
    order.view.camera.eye.x = placeOf(number_, ++asked_);
    order.format = appetite_.png ? PictureFormat::Png : PictureFormat::Jpeg;
    const auto next = [this] {
        time_.after(appetite_.pauseMs * chance_.between(0.2, 1.8), [this] { ask(); });
    };
    waitsFor_ = asked_;
    const auto snapshot =
        server_.snapshot(std::move(order), [this, next, mine = asked_](const Expected<EncodedPicture>&) {
            if (waitsFor_ == mine) waitsFor_ = 0;
            time_.after(0, next);
        });
    if (snapshot == 0) return next();  // refused: the queue is full
    if (!chance_.happens(appetite_.impatience)) return;
    time_.after(chance_.scale(1, 5000), [this, snapshot, mine = asked_] {
        if (waitsFor_ != mine) return;
        server_.abandonSnapshot(snapshot);
        time_.after(mostAfterwards, [this, snapshot] {
            if (server_.worksOn(snapshot)) server_.violate("work goes on for a client that has gone");
        });
    });
}

}  // namespace scancast::simulation
