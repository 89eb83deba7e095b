#include "server/stream/link_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {
namespace {

// A path's latency is remembered for one to two periods: it changes rarely, bandwidth often.
constexpr std::chrono::seconds period{3};
// While nothing contradicts it the estimate rises: gently around what the link has been found to carry, and
// after a while so fast that it comes from the poorest frames to the best in half a second.
constexpr double gentle = 1, fast = 8;  // doublings a second
// What a rise does is known a round trip later: on a long way no more than this many until then.
constexpr double mostUnseen = 0.75;
constexpr double patience = 0.3;      // s
constexpr double longestRise = 0.25;  // s; a pause proves nothing
// One late acknowledgement may be somebody's microwave oven; the next one corrects it.
constexpr double deepestFall = 0.25;

double seconds(LinkEstimate::Time from, LinkEstimate::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void LinkEstimate::sent(std::uint64_t frame, std::size_t bytes, Time now) {
    flights_.push_back({frame, bytes, now, flights_.empty()});
}

bool LinkEstimate::wantsQuiet(Time now) const {
    return !flights_.empty() && !flights_.back().alone && now - lastClear_ > period;
}

double LinkEstimate::wantedQuiet(Time now) const {
    return std::max(seconds(lastClear_ + period, now), 0.0);
}

double LinkEstimate::latency() const {
    const double quickest = std::min(quickest_, quickestBefore_);
    return quickest == never ? 0 : quickest;
}

void LinkEstimate::acknowledged(std::uint64_t frame, double interval, Time now) {
    // Frames that one acknowledgement stands for count as one.
    std::optional<Flight> first;
    double bytes = 0;
    while (!flights_.empty() && flights_.front().frame <= frame) {
        if (!first) first = flights_.front();
        bytes += double(flights_.front().bytes);
        flights_.pop_front();
    }
    if (!first) return;
    const Time start = lastAck_ ? std::max(*lastAck_, first->sent) : first->sent;
    const double overlap = seconds(first->sent, start);  // while the frame before was still on its way
    const double elapsed = lastAck_ ? seconds(*lastAck_, now) : 0;
    constexpr double clockTick = 1e-6;
    const double longest = std::max(seconds(start, now), clockTick);
    lastAck_ = now;
    noteRoundTrip(seconds(first->sent, now), overlap, bandwidth_ ? bytes / *bandwidth_ : 0, now);
    const double shortest = longest - std::max(latency() - overlap, 0.0);
    moveInto(bytes / longest, shortest > clockTick ? bytes / shortest : never, 2 * bytes / interval, elapsed);
}

// A frame that had to wait for the one before says nothing about latency: then the one before was still on the line when this one came
// there, and arrived less than `onLine` seconds before it.
void LinkEstimate::noteRoundTrip(double roundTrip, double overlap, double onLine, Time now) {
    if (overlap > 0 && overlap + onLine >= std::max(latency(), onLine)) return;
    lastClear_ = now;
    if (now - periodStart_ > period) {
        quickestBefore_ = now - periodStart_ > 2 * period ? never : quickest_;
        quickest_ = never;
        periodStart_ = now;
    }
    quickest_ = std::min(quickest_, roundTrip);
}

void LinkEstimate::moveInto(double lower, double upper, double ceiling, double elapsed) {
    if (!bandwidth_) {
        if (upper < never) bandwidth_ = upper;
        return;
    }
    uncontradicted_ += std::min(elapsed, longestRise);
    const double seen = latency() > 0 ? std::min(fast, mostUnseen / latency()) : fast;
    const double rate = uncontradicted_ > patience ? std::max(seen, gentle) : gentle;
    const double risen = *bandwidth_ * std::exp2(rate * std::min(elapsed, longestRise));
    const double estimate = std::max({*bandwidth_, std::min(risen, ceiling), lower});
    if (upper < estimate) uncontradicted_ = 0;
    bandwidth_ = std::max(std::min(estimate, upper), *bandwidth_ * deepestFall);
}

}  // namespace scancast
