// How many frames may be on their way to a client before it acknowledges one: as many as the line holds, and one that waits for it.
// Fewer leave a long line idle; more only wait in a router's buffer, or in ours, and are old when they are seen.
//
// What a line holds is its rate times its round trip (Little). The rate is that of acknowledgements, in frames: each frame remembers how
// many had arrived when it went out, so that an acknowledgement says how many arrived within its round trip (N. Cardwell et al., "BBR:
// Congestion-Based Congestion Control", ACM Queue 14(5), 2016); of the last two rounds the greater counts. A client that decodes
// slowly is a slow line like any other. The round trip is the link estimate's quickest. The frame that waits is what finds out whether
// there is room for one more. The window falls at once where a frame takes longer than the line and its own waiting explain, and nothing
// more is begun while the oldest frame is late.
//
// Owned by a stream session; one thread, no clock of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/stream/link_estimate.hpp"

namespace scancast {

class SendWindow {
  public:
    using Time = LinkEstimate::Time;
    /// However little is known, and however slow the line: one is made while another is on its way.
    static constexpr std::size_t fewest = 2;

    /// A moving frame goes out that took `making` seconds from its order on; `others` are being made.
    void sentMoving(std::uint64_t frame, std::size_t bytes, double making, std::size_t others, Time now);
    /// A still goes out: a line that is busy with one tells nothing of moving frames.
    void sentStill(std::uint64_t frame, std::size_t bytes, Time now);
    /// This frame and all before it have arrived, and the link's estimate knows.
    void acknowledged(std::uint64_t frame, const LinkEstimate& link, Time now);

    /// Frames that may be on their way and being made now, in [fewest, maxUnacknowledgedFrames].
    std::size_t frames(Time now) const;
    /// The same while a frame is to find the line without a queue, `wanted` seconds after that was wanted first: fewer from round trip to
    /// round trip, at last one.
    std::size_t quietFrames(double wanted) const;

  private:
    struct Flight {
        std::uint64_t frame = 0;
        std::size_t bytes = 0;
        Time sent;
        std::uint64_t delivered = 0;  // frames that had arrived by then
        Time deliveredAt;             // when the last of them had
        bool moving = false;
        bool tells = false;  // moving, and behind none that is not
        bool full = false;   // no other could have been under way
    };

    void send(std::uint64_t frame, std::size_t bytes, bool moving, bool full, Time now);
    void noteRate(double rate, bool full, bool late, Time now);
    double rate() const;
    double held() const;
    double longest() const;
    std::size_t window() const;

    std::deque<Flight> flights_;  // oldest first
    std::size_t flyingBytes_ = 0;
    std::uint64_t delivered_ = 0;
    Time deliveredAt_;
    double base_ = 0;               // s, of a round trip without a queue; 0 = nothing has arrived yet
    double jitter_ = 0;             // s, between neighbours, smoothed
    std::optional<double> before_;  // round trip of the newest frame that tells, s
    double making_ = 0;             // s, smoothed
    double typical_ = 0;            // bytes of a moving frame, smoothed
    std::optional<double> bandwidth_;
    double rate_ = 0, rateBefore_ = 0;  // frames/s: the greatest of this round and of the one before
    Time roundStart_;
    bool growing_ = true;  // nothing has waited for the line yet
};

}  // namespace scancast
