// Which stills a view that stands gets, and when: after a moment of quiet, stills that get sharper while blocks
// are still being read, and then the final one, which waits for everything. Nothing here has a clock, draws or
// sends.
//
// Owned by a stream session; its thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace scancast {

struct StillTimes {
    std::chrono::milliseconds quiet{150};     ///< without a new view before the first still is made
    std::chrono::milliseconds interval{100};  ///< between stills that get sharper
};

class StillPlan {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// A still is drawn with what is in memory; the final one with everything.
    enum class Still : std::uint8_t { AsFarAsRead, Final };

    explicit StillPlan(const StillTimes& times) : times_(times) {}

    /// Another view is shown. `mayLack`: some of its samples may not have been read yet.
    void begin(bool mayLack, Time now);
    /// What to order now, if anything; `busy` = pictures are still being made, `stillComing` = one is a still.
    std::optional<Still> due(bool busy, bool stillComing, Time now) const;
    /// When due() will have an answer, pictures being made or not; empty when only a picture brings the next one.
    std::optional<Time> dueAt(bool busy) const;
    /// It has been ordered.
    void ordered(Still still);
    /// A still that is not the final one lacked that many samples.
    void drawn(std::uint64_t samplesMissing, Time now);
    /// ... or could not be drawn: no second try, the final one has its own.
    void failed() { stillsLeft_ = 0; }

  private:
    const StillTimes times_;
    Time since_;                      // when the view came
    bool finalWanted_ = false;        // it has not been ordered
    int stillsLeft_ = 0;              // before the final one is ordered, whatever is missing
    std::uint64_t leastMissing_ = 0;  // of the stills so far
    Time next_;
};

}  // namespace scancast
