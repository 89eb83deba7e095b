// How many requests of a file are under way at once, and how large they are, by how long they take: on a quick line few round trips
// matter, on a slow one that each comes to its end soon, so that what was asked for first is there first and nothing is given up half way.
// Pure but for the clock given; its owner guards it. Place: remote file → **request pace** → requests.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace scancast {

struct PaceLimits {
    std::size_t requests = 12;              ///< at once, at most
    std::uint64_t pieces = 16;              ///< of one request, at most
    std::chrono::milliseconds quick{3000};  ///< who takes less lets more be asked for
    std::chrono::milliseconds slow{8000};   ///< who takes more, less
};

class RequestPace {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// `first`: what a request of one piece took, the first of all.
    RequestPace(const PaceLimits& limits, std::chrono::nanoseconds first);

    std::size_t requests() const;
    std::uint64_t pieces() const;
    /// A request has ended, well or because it took too long.
    void ended(Time begun, Time now, bool well);

  private:
    std::uint64_t most() const { return limits_.requests * limits_.pieces; }

    PaceLimits limits_;
    std::uint64_t budget_;  // pieces of all requests that are under way
    Time changedAt_{};      // requests of before say nothing about the pace since
};

}  // namespace scancast
