#include "server/net/session_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "server/catalog/describe_point.hpp"
#include "server/net/api/handler.hpp"
#include "server/net/log/shown_target.hpp"

namespace scancast {

namespace asio = boost::asio;

namespace {

/// The same on all servers that know the same tokens and keys.
std::string ownerOf(const Identity& identity) {
    return fmt::format("{}\n{}\n{}", int(identity.kind), identity.name, identity.cloud);
}

}  // namespace

SessionHost::SessionHost(const Executor& strand, NetContext& context, Grant grant, RequestRecord record)
    : context_(context),
      strand_(strand),
      grant_(std::move(grant)),
      world_(clouds(), context.api.admission()),
      timer_(strand),
      grantTimer_(strand),
      record_(std::move(record)) {}

SessionHost::~SessionHost() {
    if (session_)
        std::ignore =
            contained("Ending a session", [this] { session_->connectionLost(false, Clock::now()); });
    leave();
    if (!counted_) return;
    context_.sessions.fetch_sub(1);
    context_.metrics.sessionClosed();
}

void SessionHost::take(ConnectionRegister::Place place) {
    place_ = std::move(place);
    place_.heldBy(shared_from_this());
}

void SessionHost::leave() {
    timer_.cancel();
    grantTimer_.cancel();
    if (mailbox_ != 0) context_.scheduler.closeMailbox(std::exchange(mailbox_, 0));
    if (std::exchange(ended_, true)) return;
    tell(session_ ? RequestRecord::Event::StreamEnded : RequestRecord::Event::Request);
}

void SessionHost::endsBecause(std::string_view why) noexcept {
    if (record_.note.empty()) std::ignore = contained("The request log", [&] { record_.note = why; });
}

void SessionHost::tell(RequestRecord::Event event) noexcept {
    record_.event = event;
    context_.requestLog.add(record_);
}

void SessionHost::fault() noexcept {
    if (context_.connections.shuttingDown()) return;
    endsBecause("a fault of the server");
    giveUp();
    std::ignore = contained("Closing a connection", [this] {
        leave();
        cut();
    });
}

bool SessionHost::openSession(ClientKind client, SessionOptions options) {
    if (context_.sessions.fetch_add(1) >= context_.limits.maxSessions) {
        context_.sessions.fetch_sub(1);
        return false;
    }
    counted_ = true;
    context_.metrics.sessionOpened();
    mailbox_ = context_.scheduler.openMailbox();
    registration_ = context_.sessionRegister.enter(client, weak_from_this());
    options.registration = registration_.get();
    options.id = registration_->id();
    options.owner = ownerOf(grant_.identity);
    options.maxPixels = context_.limits.maxPixels;
    options.mayFollow = grant_.identity.kind != IdentityKind::Guest;
    options.stills.quiet = context_.limits.quiet;
    options.helloPatience = context_.limits.helloTimeout;
    session_.emplace(std::move(options), world_, *this, context_.metrics, Clock::now());
    record_.session = shownSession(registration_->id());
    tell(RequestRecord::Event::StreamOpened);
    // In the register now, so a grant that is withdrawn from here on is heard of; it may have been before.
    lookAtGrant();
    keepTime();
    return true;
}

void SessionHost::lookAtGrant() {
    using SystemClock = std::chrono::system_clock;
    if (!session_ || session_->closed()) return;
    const SystemClock::time_point now = SystemClock::now();
    if (const char* why = grant_.ended(now)) return session_->dismiss(why);
    if (!grant_.until) return;
    // The time of day may be set: it is looked at again and again.
    constexpr std::chrono::seconds longest{30};
    grantTimer_.expires_after(std::min<SystemClock::duration>(*grant_.until - now, longest));
    grantTimer_.async_wait([weak = weak_from_this()](boost::system::error_code ec) {
        const auto self = weak.lock();
        if (self && !ec && self->listening()) onBehalfOf(*self, [&] { self->lookAtGrant(); });
    });
}

template <class Work>
void SessionHost::later(const Executor& strand, const Weak& weak, Work work) {
    asio::post(strand, [weak, work = std::move(work)]() mutable {
        const auto self = weak.lock();
        if (!self || !self->session_ || !self->listening()) return;
        onBehalfOf(*self, [&] {
            work(*self->session_);
            self->keepTime();
        });
    });
}

void SessionHost::shutDown() {
    asio::post(strand_, [weak = weak_from_this()] {
        const auto self = weak.lock();
        if (!self) return;
        onBehalfOf(*self, [&] {
            if (self->session_) return self->session_->goAway();
            self->cut();  // still shaking hands, or refused already
        });
    });
}

void SessionHost::changeView(messages::ViewChange change, Changed done) {
    asio::post(strand_, [weak = weak_from_this(), change = std::move(change), done = std::move(done)] {
        const auto self = weak.lock();
        if (!self || !self->session_ || !self->listening())
            return done(tl::unexpected(problemOf(404, "This session has ended.")));
        onBehalfOf(*self, [&] {
            done(self->session_->change(change, Clock::now()));
            self->keepTime();
        });
    });
}

void SessionHost::lookAround() {
    if (willLook_.exchange(true)) return;
    const auto posted = contained("Telling a session", [this] {
        asio::post(strand_, [weak = weak_from_this()] {
            const auto self = weak.lock();
            if (!self) return;
            self->willLook_ = false;
            if (!self->session_ || !self->listening()) return;
            onBehalfOf(*self, [&] {
                self->lookAtGrant();
                self->session_->lookAround(Clock::now());
                self->keepTime();
            });
        });
    });
    if (!posted) willLook_ = false;  // or it would never look again
}

void SessionHost::moveOn(const messages::Drain& drain) {
    std::ignore = contained("Telling a session", [&] {
        later(strand_, weak_from_this(), [drain](StreamSession& session) { session.moveOn(drain); });
    });
}

void SessionHost::order(std::uint64_t number, PictureOrder order) {
    context_.scheduler.request(mailbox_, std::move(order), doneFor(number));
}

bool SessionHost::replaceWaiting(std::uint64_t number, PictureOrder order) {
    return context_.scheduler.replaceWaiting(mailbox_, std::move(order), doneFor(number));
}

void SessionHost::abandon() {
    context_.scheduler.abandon(mailbox_);
}

// Answers come from other threads, or at once from here; either way they are posted.
void SessionHost::pick(std::uint64_t seq, std::shared_ptr<const Cloud> cloud,
                       std::shared_ptr<const PlannedView> planned, double x, double y) {
    auto done = [strand = strand_, weak = weak_from_this(), seq,
                 cloud](Expected<std::optional<Picked>> picked) {
        auto point = picked.map([&](const std::optional<Picked>& found) {
            return found ? pickedJson(*cloud, *found) : nlohmann::json();
        });
        later(strand, weak, [seq, point = std::move(point)](StreamSession& session) mutable {
            session.pickDone(seq, std::move(point));
        });
    };
    if (auto asked = context_.api.picker().pick(cloud, std::move(planned), x, y, done); !asked)
        done(tl::unexpected(std::move(asked.error())));
}

std::function<void()> SessionHost::onTaken() {
    return [strand = strand_, weak = weak_from_this()] {
        later(strand, weak, [](StreamSession& session) { session.taken(); });
    };
}

PictureDone SessionHost::doneFor(std::uint64_t number) {
    return [strand = strand_, weak = weak_from_this(), number](Expected<EncodedPicture> result) {
        later(strand, weak, [number, result = std::move(result)](StreamSession& session) mutable {
            session.pictureDone(number, std::move(result), Clock::now());
        });
    };
}

void SessionHost::keepTime() {
    const auto wake = session_->wakeAt();
    if (wake == armed_) return;
    armed_ = wake;
    timer_.cancel();
    if (!wake) return;
    timer_.expires_at(*wake);
    timer_.async_wait([weak = weak_from_this()](boost::system::error_code ec) {
        const auto self = weak.lock();
        if (!self || ec || !self->listening()) return;
        onBehalfOf(*self, [&] {
            self->armed_.reset();
            self->session_->tick(Clock::now());
            self->keepTime();
        });
    });
}

}  // namespace scancast
