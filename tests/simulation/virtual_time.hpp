// Time that passes only from event to event, and chance that comes from a seed: what makes a simulated minute
// take milliseconds, and come out the same every time.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace scancast::simulation {

using Time = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

inline Duration milliseconds(double ms) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(ms));
}
inline double inMilliseconds(Duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

class VirtualTime {
  public:
    Time now() const { return now_; }
    /// Events of the same time come in the order in which they were asked for.
    void at(Time time, std::function<void()> event) {
        events_.push({std::max(time, now_), ++count_, std::move(event)});
    }
    void after(double ms, std::function<void()> event) { at(now_ + milliseconds(ms), std::move(event)); }
    /// The next event, unless it is later than `end`; false = there is none.
    bool step(Time end) {
        if (events_.empty() || events_.top().time > end) return false;
        const Event next = events_.top();
        events_.pop();
        now_ = next.time;
        next.happen();
        return true;
    }
    std::uint64_t events() const { return count_; }

  private:
    struct Event {
        Time time;
        std::uint64_t number;
        std::function<void()> happen;
        bool operator<(const Event& other) const {
            return std::pair(time, number) > std::pair(other.time, other.number);
        }
    };
    Time now_{std::chrono::hours(1)};
    std::uint64_t count_ = 0;
    std::priority_queue<Event> events_;
};

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA
/// 2014): the same numbers with every compiler.
class Chance {
  public:
    explicit Chance(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }
    double unit() { return double(bits() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    /// As many small ones as large ones.
    double scale(double low, double high) { return low * std::pow(high / low, unit()); }
    int below(int count) { return int(unit() * count); }
    bool happens(double probability) { return unit() < probability; }

  private:
    std::uint64_t state_;
};

}  // namespace scancast::simulation
