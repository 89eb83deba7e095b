// How long to wait before the next attempt: longer after each, so that a server that comes back is not
// overrun by all its clients at once. A plain value; any thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>

namespace scancast::client {

struct Backoff {
    std::chrono::milliseconds first{250}, longest{8'000};
    double factor = 2;

    /// Before attempt 0, 1, …; `chance` in [0, 1) takes up to half of it away.
    std::chrono::milliseconds delay(int attempt, double chance) const {
        const double whole = std::min(static_cast<double>(first.count()) * std::pow(factor, attempt),
                                      static_cast<double>(longest.count()));
        return std::chrono::milliseconds(static_cast<std::int64_t>(whole * (1 - chance / 2)));
    }
};

}  // namespace scancast::client
