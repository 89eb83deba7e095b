// Which lines of the request log are written, so that nobody can fill a disk by asking: of those that say the same
// the first ones of a minute, and how many more there were.
//
// A policy without clock, threads or files: the caller says what time it is. Owned by the request log; with its lock
// held. Bounded: in what it remembers, and in the lines that it lets through.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace scancast {

struct RepeatLimits {
    std::chrono::seconds window{60};
    std::uint64_t failing = 5;   ///< lines in a window of one client, status and route that tell of a failure
    std::uint64_t served = 600;  ///< of one client's other requests
    std::uint64_t all = 6000;    ///< of everybody
    std::size_t remembered = 1024;  ///< kinds that are told apart; further ones are one
    std::size_t told = 20;          ///< kinds whose repeats are told one by one; of the others the sum
};

/// What says the same: failures of one status, or whatever was served.
struct RepeatKind {
    std::string client;  ///< empty = several
    int status = 0;      ///< 0 = whatever was served, or several
    std::string route;   ///< empty = several
    auto operator<=>(const RepeatKind&) const = default;
};

/// Lines that were not written.
struct Repeated {
    RepeatKind kind;
    std::uint64_t times = 0;
    bool operator==(const Repeated&) const = default;
};

class Repeats {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// Nothing is left out without limits.
    explicit Repeats(const std::optional<RepeatLimits>& limits) : limits_(limits) {}

    /// Whether a line of a request is written. After passTime() of the same moment.
    bool admit(const std::string& client, int status, std::string_view route, Time now);
    /// What was left out in a window that is over; the next one begins with the next line.
    std::vector<Repeated> passTime(Time now);
    /// The same of the window that is not over: at the end of the server.
    std::vector<Repeated> finish();
    std::size_t remembered() const { return lines_.size(); }

  private:
    struct Lines {
        std::uint64_t written = 0, leftOut = 0;
    };

    const std::optional<RepeatLimits> limits_;
    std::optional<Time> began_;  ///< the window; empty = nothing has been said in it
    std::uint64_t written_ = 0;
    std::map<RepeatKind, Lines> lines_;
};

}  // namespace scancast
