// Which stills a view that stands gets, and when. After a moment of quiet the final one, if all that it needs
// is in memory. If not, that is asked for, and tried again soon: where it was only a disk away, the final one
// comes then. Else stills that get sharper while blocks arrive, and at last the final one that waits for
// everything. Nothing here has a clock, draws or sends.
//
// Owned by a stream session; its thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace scancast {

struct StillTimes {
    std::chrono::milliseconds quiet{150};     ///< without a new view before the first still is made
    std::chrono::milliseconds retry{50};      ///< between trials
    std::chrono::milliseconds interval{100};  ///< between stills that get sharper
    std::chrono::milliseconds away{
        2000};  ///< before a final one is tried again whose blocks could not be had
};

class StillSchedule {
  public:
    using Time = std::chrono::steady_clock::time_point;
    enum class Still : std::uint8_t {
        Trial,    ///< with everything, if that is in memory: then it is the final one
        Sharper,  ///< one sample a pixel, with what is in memory
        Final,    ///< with everything, whatever that takes
    };

    explicit StillSchedule(const StillTimes& times) : times_(times) {}

    /// Another view is shown. `mayLack`: some of its samples may not have been read yet.
    void begin(bool mayLack, Time now);
    /// What to order now, if anything; `busy` = pictures are still being made, `stillComing` = one is a
    /// still.
    std::optional<Still> due(bool busy, bool stillComing, Time now) const;
    /// When due() will have an answer, pictures being made or not; empty when only a picture brings the next
    /// one.
    std::optional<Time> dueAt(bool busy) const;
    /// The final one is still to come, and nothing has been ordered of it.
    bool wanted() const { return finalWanted_; }
    /// It has been ordered.
    void ordered(Still still);
    /// A trial came to nothing: samples are missing.
    void lacked(Time now);
    /// A still was drawn; `samplesMissing` from it.
    void drawn(Still still, std::uint64_t samplesMissing, Time now);
    /// What the final one needs cannot be had at present: it is ordered again later, and what is shown stays. Where no picture
    /// of this view has said so yet, a sharper one comes first, at once, that does.
    void away(Time now);
    /// A picture said that what it lacks cannot be had at present.
    void saidAway() { awayToSay_ = false; }
    /// One that is not the final one could not be drawn: no second try, the final one has its own.
    void failed() { stillsLeft_ = 0; }

  private:
    const StillTimes times_;
    Time since_;                      // when the view came
    bool finalWanted_ = false;        // it has not been ordered
    bool trialNext_ = false;          // else a sharper one
    int trialsLeft_ = 0;              // before the first sharper one
    int stillsLeft_ = 0;              // before the final one is ordered, whatever is missing
    bool awayToSay_ = true;           // of this view
    std::uint64_t leastMissing_ = 0;  // of the stills so far
    Time next_;
};

}  // namespace scancast
