// How fast the network takes frames, from nothing but when they were sent and when they were acknowledged.
//
// Every acknowledgement says of the bandwidth that it lies between two bounds. The link was busy with a frame
// for no longer than the time since the acknowledgement before it; and for no less than what of that time the
// latency, which is at most the quickest round trip of late, does not explain. The estimate moves into those
// bounds only as far as it must, from above: it never calls a link slow because it is long (a satellite's) or
// because little was sent, and it is unknown until an acknowledgement proves that bytes cost time.
//
// Owned by a stream's quality controller; one thread, no clock of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

namespace scancast {

class LinkEstimate {
  public:
    using Time = std::chrono::steady_clock::time_point;

    void sent(std::uint64_t frame, std::size_t bytes, Time now);
    /// This frame and all before it have arrived. `interval`: seconds that a frame should take; the estimate
    /// rises no further than twice what frames of this size need for that.
    void acknowledged(std::uint64_t frame, double interval, Time now);

    /// Bytes a second; nullopt = nothing has shown a limit yet.
    std::optional<double> bandwidth() const { return bandwidth_; }
    /// Send less than the link takes, until a frame has not waited for the one before: it is long ago that one did not, and only
    /// such a one tells latency from waiting.
    bool wantsQuiet(Time now) const;
    /// Seconds for which that has been so.
    double wantedQuiet(Time now) const;
    /// Seconds of a round trip that no smaller frame would save; 0 before the first acknowledgement.
    double latency() const;

  private:
    static constexpr double never = std::numeric_limits<double>::infinity();
    struct Flight {
        std::uint64_t frame = 0;
        std::size_t bytes = 0;
        Time sent;
        bool alone = false;
    };

    void noteRoundTrip(double seconds, double overlap, double onLine, Time now);
    void moveInto(double lower, double upper, double ceiling, double elapsed);

    std::deque<Flight> flights_;  // oldest first; as many as may be unacknowledged
    std::optional<Time> lastAck_;
    std::optional<double> bandwidth_;
    double quickest_ = never, quickestBefore_ = never;  // round trips of this period and the one before, s
    Time periodStart_, lastClear_;
    double uncontradicted_ = 0;  // s since an upper bound last held the estimate down
};

}  // namespace scancast
