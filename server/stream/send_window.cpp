#include "server/stream/send_window.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/messages.hpp"

namespace scancast {
namespace {

constexpr double smoothing = 0.2;
// At first, half as many again as have been found to fit: from two frames to nine within a few round trips.
constexpr double growth = 1.5;
// A frame that is later than its own turn on the line: then there is a queue, and growth ends.
constexpr double waited = 0.75;
// What a frame may take beyond the quickest: two turns on the line or a quarter of the round trip, and what they differ by anyway.
constexpr double mostTurns = 2, partOfTrip = 0.25, mostJitter = 3;
// Jitter is no reason to leave the line idle, but may be a queue that comes and goes.
constexpr double jitterHeld = 0.25;
// Of the bandwidth, which the estimate errs about: bytes say something where a still has the line, not between moving frames.
constexpr double bytesHeld = 1.5;
constexpr double quietPart = 0.75;

double secondsPassed(SendWindow::Time from, SendWindow::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void SendWindow::sentMoving(std::uint64_t frame, std::size_t bytes, double making, std::size_t others,
                            Time now) {
    making_ += smoothing * (making - making_);
    typical_ = typical_ == 0 ? double(bytes) : typical_ + smoothing * (double(bytes) - typical_);
    send(frame, bytes, true, flights_.size() + 1 + others >= window(), now);
}

void SendWindow::sentStill(std::uint64_t frame, std::size_t bytes, Time now) {
    send(frame, bytes, false, false, now);
}

void SendWindow::send(std::uint64_t frame, std::size_t bytes, bool moving, bool full, Time now) {
    if (flights_.empty()) deliveredAt_ = now;
    const bool tells = moving && std::ranges::all_of(flights_, &Flight::moving);
    flights_.push_back({frame, bytes, now, delivered_, deliveredAt_, moving, tells, full});
    flyingBytes_ += bytes;
}

void SendWindow::acknowledged(std::uint64_t frame, const LinkEstimate& link, Time now) {
    std::optional<Flight> newest;
    while (!flights_.empty() && flights_.front().frame <= frame) {
        newest = flights_.front();
        flyingBytes_ -= newest->bytes;
        flights_.pop_front();
        ++delivered_;
    }
    if (!newest) return;
    deliveredAt_ = now;
    base_ = link.latency();
    bandwidth_ = link.bandwidth();
    if (!newest->tells) return before_.reset();
    const double roundTrip = secondsPassed(newest->sent, now);
    if (before_) jitter_ += smoothing * (std::abs(roundTrip - *before_) - jitter_);
    before_ = roundTrip;
    constexpr double clockTick = 1e-6;
    const double sample =
        double(delivered_ - newest->delivered) / std::max(secondsPassed(newest->deliveredAt, now), clockTick);
    if (roundTrip > base_ + jitter_ + waited / sample) growing_ = false;
    noteRate(sample, newest->full, roundTrip > longest(), now);
}

// Who sends less than he may has not found out how much the line carries: that lowers nothing.
void SendWindow::noteRate(double sample, bool full, bool late, Time now) {
    if (late) {
        rate_ = rateBefore_ = std::min(sample, rate());
        roundStart_ = now;
        return;
    }
    if (full && secondsPassed(roundStart_, now) > base_ + jitter_) {
        rateBefore_ = rate_;
        rate_ = 0;
        roundStart_ = now;
    }
    if (full || sample > rate()) rate_ = std::max(rate_, sample);
}

double SendWindow::rate() const {
    return std::max(rate_, rateBefore_);
}

/// Frames that the line holds, those that are being made for it included.
double SendWindow::held() const {
    return rate() * (base_ + std::min(jitter_, base_ * jitterHeld) + making_);
}

/// Seconds after which a frame is late.
double SendWindow::longest() const {
    const double turns = rate() > 0 ? mostTurns / rate() : 0;
    return base_ + mostJitter * std::min(jitter_, base_) + std::max(turns, base_ * partOfTrip);
}

std::size_t SendWindow::window() const {
    const double found = std::floor(held() + 1.5);  // and one that waits
    const double wanted = growing_ ? std::max(found, std::floor(held() * growth + 1)) : found;
    return std::size_t(std::clamp(wanted, double(fewest), double(maxUnacknowledgedFrames)));
}

std::size_t SendWindow::frames(Time now) const {
    if (flights_.empty() || base_ == 0) return window();
    const bool late = secondsPassed(flights_.front().sent, now) > longest();
    const bool full =
        bandwidth_ && double(flyingBytes_) > bytesHeld * *bandwidth_ * (base_ + jitter_) + typical_;
    return late || full ? fewest : window();
}

std::size_t SendWindow::quietFrames(double wanted) const {
    const double rounds = 1 + std::floor(wanted / std::max(base_ + jitter_, 1e-3));
    return std::size_t(std::max(std::floor(held() * std::pow(quietPart, rounds)), 1.0));
}

}  // namespace scancast
