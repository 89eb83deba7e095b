// How long something has been going on, for what a frame tells of itself.
#pragma once

#include <chrono>

namespace scancast {

using Clock = std::chrono::steady_clock;

inline double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace scancast
