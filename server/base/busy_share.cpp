#include "server/base/busy_share.hpp"

#include <algorithm>

namespace scancast {
namespace {

constexpr std::chrono::steady_clock::duration oneSecond = std::chrono::seconds(1);

std::int64_t secondOf(BusyShare::Time time) {
    return time.time_since_epoch() / oneSecond;
}

}  // namespace

void BusyShare::begin(Time now) {
    const std::lock_guard lock(mutex_);
    since_ = now;
}

void BusyShare::end(Time now) {
    const std::lock_guard lock(mutex_);
    if (since_) add(seconds_, *since_, now);
    since_.reset();
}

void BusyShare::add(Seconds& seconds, Time from, Time to) {
    // What came before the window is in none of its seconds.
    from = std::max(from, Time(oneSecond * (secondOf(to) - window + 1)));
    while (from < to) {
        const std::int64_t number = secondOf(from);
        const Time end = std::min(to, Time(oneSecond * (number + 1)));
        Second& second = seconds[std::size_t(number % window)];
        if (second.number != number) second = {number, {}};
        second.busy += end - from;
        from = end;
    }
}

double BusyShare::of(Time now) const {
    Seconds seconds;
    {
        const std::lock_guard lock(mutex_);
        seconds = seconds_;
        if (since_) add(seconds, *since_, now);
    }
    const std::int64_t last = secondOf(now), first = last - window + 1;
    Clock::duration busy{};
    for (const Second& second : seconds)
        if (second.number >= first && second.number <= last) busy += second.busy;
    const Clock::duration all = now - Time(oneSecond * first);
    return std::clamp(std::chrono::duration<double>(busy) / all, 0.0, 1.0);
}

}  // namespace scancast
