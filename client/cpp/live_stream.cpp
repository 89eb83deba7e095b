#include "client/cpp/live_stream.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "protocol/view/view_json.hpp"

namespace scancast::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t mostWaiting = 64;

/// The next attempt would end the same way.
bool isFinal(const Error& error) {
    switch (error.code) {
        case ErrorCode::InvalidArgument:
        case ErrorCode::ImpossibleView:
        case ErrorCode::Unsupported:
        case ErrorCode::Malformed:
            return true;
        default:
            return false;
    }
}

/// Of an older server: it refuses words that it does not know, those of the view excepted, which have names of their own.
bool isUnknownCodecs(const Error& error) {
    return error.field.starts_with("codecs");
}
bool isUnknownWord(const Error& error) {
    return error.field == "view" || error.field == "seq" || error.field == "frame";
}

double chance() {
    thread_local std::minstd_rand random(std::random_device{}());
    return std::uniform_real_distribution<double>(0, 1)(random);
}

template <class Callback, class... Arguments>
void tell(const Callback& callback, Arguments&&... arguments) {
    if (callback) callback(std::forward<Arguments>(arguments)...);
}

}  // namespace

LiveStream::LiveStream(ServerUrl url, messages::Hello hello, LiveListener listener, LiveOptions options)
    : url_(std::move(url)),
      listener_(std::move(listener)),
      options_(std::move(options)),
      hello_(std::move(hello)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LiveStream::~LiveStream() {
    thread_.request_stop();
    {
        const std::lock_guard lock(mutex_);
        if (stream_) stream_->interrupt();
    }
    thread_.join();
}

std::uint64_t LiveStream::show(const View& view, const std::string& cloud) {
    const std::lock_guard lock(mutex_);
    std::optional<std::string> other;
    if (!cloud.empty()) other = cloud;
    // A switch to another cloud must not be lost with the view that it came with.
    if (!other && viewWaits_ && view_) other = view_->cloud;
    view_ = messages::ViewChange{++lastSeq_, std::move(other), toJson(view)};
    viewWaits_ = true;
    if (stream_) stream_->interrupt();
    return lastSeq_;
}

bool LiveStream::send(const ClientMessage& message) {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= mostWaiting) return false;
    waiting_.push_back(message);
    if (stream_) stream_->interrupt();
    return true;
}

Expected<Stream> LiveStream::open(const Timeouts& timeouts) {
    sayWhatIsSeen();
    auto stream = Stream::open(url_, hello_, timeouts, options_.credentials);
    if (!stream && isFinal(stream.error()) && isUnknownCodecs(stream.error())) {
        hello_.codecs = {Codec::Jpeg};
        stream = Stream::open(url_, hello_, timeouts, options_.credentials);
    }
    if (stream || !isFinal(stream.error()) || hello_.view.is_null()) return stream;
    // It knows no such field, or cannot show that any more: what is to be seen is said once there is a session. What it cannot
    // show now, it or another one may show the next time.
    if (isUnknownWord(stream.error())) saysView_ = false;
    hello_.view = nullptr;
    hello_.seq = hello_.frame = 0;
    return Stream::open(url_, hello_, timeouts, options_.credentials);
}

void LiveStream::run(const std::stop_token& stop) {
    std::optional<Stream> next;  // opened while the one before was still there
    for (int attempt = 0; !stop.stop_requested(); ++attempt) {
        Error lost;
        auto stream = next ? Expected<Stream>(std::move(*next)) : open(options_.timeouts);
        next.reset();
        if (stream) {
            attempt = 0;
            attach(&*stream);
            lost = serve(*stream, stop, next);
            attach(nullptr);
            if (stop.stop_requested()) std::ignore = stream->close();  // nobody is left to be told
            if (next) {
                // It need not keep the session for anybody who comes back; the other one's frames wait for this.
                constexpr std::chrono::milliseconds patience{500};
                std::ignore = stream->close(patience);
                continue;
            }
        } else {
            lost = std::move(stream.error());
        }
        if (stop.stop_requested()) return;
        if (!wasConnected_ || isFinal(lost)) return tell(listener_.ended, lost);
        const auto wait = options_.backoff.delay(attempt, chance());
        tell(listener_.lost, lost, wait);
        if (!waitFor(stop, wait)) return;
    }
}

void LiveStream::attach(Stream* stream) {
    const std::lock_guard lock(mutex_);
    stream_ = stream;
}

bool LiveStream::waitFor(const std::stop_token& stop, std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
}

/// What a server that has never heard of the session is to go on with.
void LiveStream::sayWhatIsSeen() {
    if (!saysView_ || !wasConnected_ || !hello_.follow.empty()) return;
    const std::lock_guard lock(mutex_);
    const messages::ViewChange& seen = view_ ? *view_ : first_;
    hello_.cloud = viewWaits_ ? seen.cloud.value_or(cloud_) : cloud_;
    hello_.view = seen.changes;
    hello_.seq = seen.seq;
}

/// Whether another server at the address has taken the session on.
bool LiveStream::moveOn(std::optional<Stream>& next) {
    // The one that is here draws on, and nobody looks at what it draws meanwhile.
    constexpr std::chrono::milliseconds patience{2000};
    if (auto stream = open(
            {std::min(options_.timeouts.connect, patience), std::min(options_.timeouts.answer, patience)})) {
        next = std::move(*stream);
        return true;
    }
    moveAt_ = Clock::now() + options_.backoff.delay(moves_++, chance());
    return false;
}

/// Until the connection is lost, for which it returns the reason, until it is to stop, or until there is a `next` one.
Error LiveStream::serve(Stream& stream, const std::stop_token& stop, std::optional<Stream>& next) {
    const messages::Welcome& welcome = stream.welcome();
    moveAt_.reset();
    first_ = {welcome.seq, std::nullopt, welcome.view};
    cloud_ = welcome.cloud;
    if (welcome.session != session_) hello_.frame = 0;
    const bool resumed = wasConnected_ && welcome.session == session_;
    wasConnected_ = true;
    session_ = welcome.session;
    hello_.resume = welcome.resume;
    {
        // Whatever became of the last messages: this is what should be seen.
        const std::lock_guard lock(mutex_);
        viewWaits_ = view_.has_value();
        if (quality_) waiting_.insert(waiting_.begin(), *quality_);
    }
    tell(listener_.connected, welcome, resumed);
    auto heard = Clock::now();
    for (bool asked = false; !stop.stop_requested();) {
        if (auto sent = sendWaiting(stream); !sent) return sent.error();
        if (moveAt_ && Clock::now() >= *moveAt_ && moveOn(next)) return {};
        const auto patience = asked ? options_.timeouts.answer : options_.silence;
        const auto until = moveAt_ ? std::min(heard + patience, *moveAt_) : heard + patience;
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
        auto event = stream.receiveFor(std::max(left, std::chrono::milliseconds(0)));
        if (!event) return event.error();
        if (*event) {
            heard = Clock::now();
            asked = false;
            if (auto handled = handle(stream, std::move(**event)); !handled) return handled.error();
        } else if (Clock::now() >= heard + patience) {
            if (asked) return {ErrorCode::DeadlineExceeded, url_.authority() + " has fallen silent", {}};
            if (auto sent = stream.send(messages::Ping{}); !sent) return sent.error();
            asked = true;
            heard = Clock::now();
        }
    }
    return {ErrorCode::Cancelled, "the stream was closed", {}};
}

Expected<void> LiveStream::sendWaiting(Stream& stream) {
    std::vector<ClientMessage> messages;
    {
        const std::lock_guard lock(mutex_);
        messages.swap(waiting_);
        for (const auto& message : messages)
            if (const auto* limits = std::get_if<messages::QualityLimits>(&message)) remember(*limits);
        if (viewWaits_) {
            if (view_->cloud) hello_.cloud = cloud_ = *view_->cloud;
            messages.push_back(*view_);
        }
        viewWaits_ = false;
    }
    for (const auto& message : messages)
        if (auto ok = stream.send(message); !ok) return ok;
    return {};
}

/// Limits that are not given stay as they were, over a new connection, too.
void LiveStream::remember(const messages::QualityLimits& limits) {
    if (!quality_) quality_.emplace();
    if (limits.fps) quality_->fps = limits.fps;
    if (limits.minResolution) quality_->minResolution = limits.minResolution;
    if (limits.maxDetail) quality_->maxDetail = limits.maxDetail;
    if (limits.minQuality) quality_->minQuality = limits.minQuality;
}

Expected<void> LiveStream::handle(Stream& stream, StreamEvent event) {
    if (auto* frame = std::get_if<ReceivedFrame>(&event)) {
        // At once, so that the server sees what the line brings and not how long the callback takes: while
        // that runs nothing is read, so the server's window bounds what waits.
        if (auto ok = stream.ack(frame->header); !ok) return ok;
        hello_.frame = frame->header.frameId;
        tell(listener_.frame, std::move(*frame));
    }
    if (const auto* stats = std::get_if<messages::Stats>(&event)) tell(listener_.stats, *stats);
    if (const auto* picked = std::get_if<messages::Picked>(&event)) tell(listener_.picked, *picked);
    if (const auto* report = std::get_if<messages::ProblemReport>(&event)) tell(listener_.problem, *report);
    if (const auto* drain = std::get_if<messages::Drain>(&event)) {
        moveAt_ = Clock::now() + std::chrono::milliseconds(drain->afterMilliseconds);
        moves_ = 0;
    }
    return {};
}

}  // namespace scancast::client
