#include "tests/simulation/traced_client.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "server/scheduler/outcome.hpp"

namespace scancast::simulation {
namespace {

constexpr std::uint64_t mostPixels = 1'000'000;

}  // namespace

std::shared_ptr<TracedClient> TracedClient::connect(int number, const Shared& shared) {
    const std::shared_ptr<TracedClient> client(new TracedClient(number, shared));
    client->mailbox_ = shared.server.openMailbox();
    client->registration_ = shared.sessions.enter(ClientKind::WebSocket, client);
    SessionOptions options;
    options.id = client->registration_->id();
    options.registration = client->registration_.get();
    options.resumable = &shared.resumable;
    options.maxPixels = mostPixels;
    client->session_.emplace(std::move(options), shared.world, *client, shared.metrics, shared.time.now());
    client->keepTime();
    return client;
}

TracedClient::TracedClient(int number, const Shared& shared) : number_(number), shared_(shared) {}

TracedClient::~TracedClient() {
    leave(false);
}

template <class Work>
void TracedClient::inSession(const Work& work) {
    if (!session_ || closed_) return;
    work(*session_);
    if (closed_) return leave(false);
    keepTime();
}

/// Not before the next event, and only if there is still a session.
template <class Work>
std::function<void()> TracedClient::later(Work work) {
    return [&time = shared_.time, weak = weak_from_this(), work = std::move(work)] {
        time.after(0, [weak, work] {
            if (const auto self = weak.lock()) self->inSession(work);
        });
    };
}

void TracedClient::keepTime() {
    const auto wake = session_->wakeAt();
    if (!wake || *wake >= timer_) return;
    timer_ = *wake;
    shared_.time.at(*wake, [weak = weak_from_this(), at = *wake] {
        const auto self = weak.lock();
        if (!self || self->timer_ != at) return;
        self->timer_ = Time::max();
        self->inSession([&](StreamSession& session) { session.tick(self->shared_.time.now()); });
    });
}

// ---- what it does

void TracedClient::say(std::string_view message) {
    if (const auto parsed = parseClientMessage(message))
        if (const auto* ack = std::get_if<messages::Ack>(&*parsed); ack && ack->frame <= lastFrame())
            acked_ = std::max(acked_, ack->frame);
    inSession([&](StreamSession& session) { session.text(message, shared_.time.now()); });
}

void TracedClient::sayBinary() {
    inSession([](StreamSession& session) { session.binary(); });
}

void TracedClient::acknowledge() {
    say(nlohmann::json{{"type", "ack"}, {"frame", lastFrame()}}.dump());
}

void TracedClient::leave(bool done) {
    if (!session_) return;
    session_->connectionLost(done, shared_.time.now());
    session_.reset();
    shared_.server.closeMailbox(std::exchange(mailbox_, 0));
    registration_.reset();
}

void TracedClient::changeView(messages::ViewChange change, Changed done) {
    later([this, change = std::move(change), done = std::move(done)](StreamSession& session) {
        done(session.change(change, shared_.time.now()));
    })();
}

void TracedClient::lookAround() {
    later([this](StreamSession& session) { session.lookAround(shared_.time.now()); })();
}

// ---- what it is told

void TracedClient::mayStillBeTold(const char* what) {
    if (closed_) shared_.server.violate(fmt::format("{} after its session was closed", what));
}

void TracedClient::sendText(std::string text) {
    mayStillBeTold("a client was sent a text");
    const auto message = parseServerMessage(text);
    if (!message)
        return shared_.server.violate("a client cannot read what it was sent: " + message.error().message);
    const auto* welcome = std::get_if<messages::Welcome>(&*message);
    if (welcome == nullptr) return;
    if (!id_.empty()) shared_.server.violate("a client was welcomed twice");
    id_ = welcome->session;
    token_ = welcome->resume;
}

void TracedClient::sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                             std::shared_ptr<const Bytes>) {
    mayStillBeTold("a client was sent a frame");
    if (id_.empty()) shared_.server.violate("a frame came before the welcome");
    if (header.pictureLength != picture->size() || picture->empty())
        shared_.server.violate("a frame's header tells another length than it has");
    if (std::uint64_t(header.width) * header.height > mostPixels)
        shared_.server.violate("a picture is larger than its session may have");
    // A session that is resumed counts on from where it was.
    if (!lastFrame_) acked_ = header.frameId - 1;
    if (lastFrame_ && header.frameId != *lastFrame_ + 1)
        shared_.server.violate("frames are not numbered in their order");
    lastFrame_ = header.frameId;
    if (*lastFrame_ - acked_ > std::uint64_t(maxUnacknowledgedFrames))
        shared_.server.violate("more frames were sent than may be without an acknowledgement");
}

PictureDone TracedClient::doneFor(std::uint64_t number) {
    return [weak = weak_from_this(), number](Expected<EncodedPicture> result) {
        const auto self = weak.lock();
        if (!self) return;
        self->later([self = self.get(), number, result = std::move(result)](StreamSession& session) {
            session.pictureDone(number, result, self->shared_.time.now());
        })();
    };
}

/// The simulated server knows views by the place that they look from (simulated_server.cpp); what this one says may be any.
PictureOrder TracedClient::placed(PictureOrder order) {
    if (!camera_ || *camera_ != order.view.camera) {
        camera_ = order.view.camera;
        ++places_;
    }
    order.view.camera.eye.x = number_ * 1e6 + double(places_);
    return order;
}

void TracedClient::order(std::uint64_t number, PictureOrder order) {
    mayStillBeTold("a picture was ordered");
    shared_.server.request(mailbox_, placed(std::move(order)), doneFor(number));
}

bool TracedClient::replaceWaiting(std::uint64_t number, PictureOrder order) {
    mayStillBeTold("a picture was ordered");
    return shared_.server.replaceWaiting(mailbox_, placed(std::move(order)), doneFor(number));
}

void TracedClient::pick(std::uint64_t seq, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>,
                        double x, double) {
    mayStillBeTold("a pick was ordered");
    shared_.time.after(20, later([seq, x](StreamSession& session) {
                           session.pickDone(seq, x < 100 ? Expected<nlohmann::json>(nlohmann::json())
                                                         : tl::unexpected(cancelled()));
                       }));
}

void TracedClient::abandon() {
    shared_.server.abandon(mailbox_);
}

void TracedClient::close(CloseCode, std::string) {
    mayStillBeTold("a client was told of the end");
    closed_ = true;
}

std::function<void()> TracedClient::onTaken() {
    return later([](StreamSession& session) { session.taken(); });
}

}  // namespace scancast::simulation
