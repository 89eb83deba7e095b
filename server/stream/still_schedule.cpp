#include "server/stream/still_schedule.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace scancast {
namespace {

// Two seconds of getting sharper; then the final still's wait brings what is missing faster than requests do.
constexpr int mostStills = 20;
// A disk answers between two of them.
constexpr int mostTrials = 2;

}  // namespace

void StillSchedule::begin(bool mayLack, Time now) {
    since_ = next_ = now;
    stillsLeft_ = mayLack ? mostStills : 0;
    trialNext_ = true;
    trialsLeft_ = mostTrials;
    leastMissing_ = std::numeric_limits<std::uint64_t>::max();
    finalWanted_ = true;
    awayToSay_ = true;
}

std::optional<StillSchedule::Still> StillSchedule::due(bool busy, bool stillComing, Time now) const {
    const auto at = dueAt(busy);
    if (!at || now < *at) return std::nullopt;
    if (stillsLeft_ > 0) return trialNext_ ? Still::Trial : Still::Sharper;
    return stillComing ? std::nullopt : std::optional(Still::Final);
}

std::optional<StillSchedule::Time> StillSchedule::dueAt(bool busy) const {
    if (!finalWanted_) return std::nullopt;
    if (stillsLeft_ <= 0) return since_ + times_.quiet;
    if (busy) return std::nullopt;
    return std::max(since_ + times_.quiet, next_);
}

void StillSchedule::ordered(Still still) {
    if (still == Still::Final) finalWanted_ = false;
}

void StillSchedule::lacked(Time now) {
    trialNext_ = --trialsLeft_ > 0;
    next_ = trialNext_ ? now + times_.retry : now;
}

void StillSchedule::away(Time now) {
    finalWanted_ = true;
    since_ = now + times_.away - times_.quiet;
    stillsLeft_ = std::exchange(awayToSay_, false) ? 1 : 0;
    if (stillsLeft_ == 0) return;
    trialNext_ = false;
    since_ = now - times_.quiet;
    next_ = now;
}

// What is missing in a still decides what comes next: another one, or the final one, which waits for the
// rest.
void StillSchedule::drawn(Still still, std::uint64_t samplesMissing, Time now) {
    if (still != Still::Sharper) {
        finalWanted_ = false;
        return;
    }
    const bool nearer = samplesMissing < leastMissing_;
    leastMissing_ = std::min(leastMissing_, samplesMissing);
    stillsLeft_ = samplesMissing == 0 ? 0 : stillsLeft_ - (nearer ? 1 : mostStills / 4);
    trialNext_ = true;
    next_ = now + times_.interval;
}

}  // namespace scancast
