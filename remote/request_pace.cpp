#include "remote/request_pace.hpp"

#include <algorithm>

namespace scancast {
namespace {

// One that is on its way, and one whose request is.
constexpr std::uint64_t leastRequests = 2;

}  // namespace

RequestPace::RequestPace(const PaceLimits& limits, std::chrono::nanoseconds first)
    : limits_(limits),
      // As many as would come within twice what is quick, were there nothing but bytes to wait for; latency makes them fewer.
      budget_(std::clamp<std::uint64_t>(
          std::uint64_t(2 * limits.quick / std::max(first, std::chrono::nanoseconds(1))), leastRequests,
          std::max(leastRequests, most()))) {}

std::size_t RequestPace::requests() const {
    return std::size_t(std::min<std::uint64_t>(limits_.requests, std::max(budget_, leastRequests)));
}

std::uint64_t RequestPace::pieces() const {
    return std::clamp<std::uint64_t>(budget_ / limits_.requests, 1, limits_.pieces);
}

void RequestPace::ended(Time begun, Time now, bool well) {
    if (begun < changedAt_) return;
    const auto took = now - begun;
    if (well && took >= limits_.quick && took <= limits_.slow) return;
    const bool isQuick = well && took < limits_.quick;
    budget_ = isQuick ? std::min(most(), 2 * budget_) : std::max(leastRequests, budget_ / 4);
    changedAt_ = now;
}

}  // namespace scancast
