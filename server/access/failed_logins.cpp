#include "server/access/failed_logins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace scancast {
namespace {

std::string_view reason(LoginFailure why) {
    switch (why) {
        case LoginFailure::Malformed:
            return "what was sent is no token";
        case LoginFailure::Unknown:
            return "the token is not one of this server's";
        case LoginFailure::Expired:
            return "the guest's time is over";
    }
    return "unknown";
}

}  // namespace

std::optional<std::chrono::seconds> FailedLogins::failed(const std::string& client, LoginFailure why,
                                                         Time now) {
    const std::lock_guard lock(mutex_);
    Address& address = addressOf(client, now);
    ++address.untold;
    address.last = why;
    tellOverdue(now);
    if (!address.told || now - *address.told >= limits_.silence) tell(address, now);
    const double seconds = std::chrono::duration<double>(now - address.counted).count();
    address.left =
        std::min(limits_.atOnce, address.left + std::max(0.0, seconds) / double(limits_.another.count()));
    address.counted = now;
    if (address.left >= 1) {
        address.left -= 1;
        return std::nullopt;
    }
    return std::chrono::seconds(
        std::max(1L, std::lround(std::ceil((1 - address.left) * double(limits_.another.count())))));
}

std::size_t FailedLogins::size() const {
    const std::lock_guard lock(mutex_);
    return addresses_.size();
}

FailedLogins::Address& FailedLogins::addressOf(const std::string& client, Time now) {
    if (const auto known = byClient_.find(client); known != byClient_.end()) {
        addresses_.splice(addresses_.begin(), addresses_, known->second);
        return addresses_.front();
    }
    if (addresses_.size() >= limits_.addresses) {
        forgotten_ += addresses_.back().untold;
        byClient_.erase(addresses_.back().client);
        addresses_.pop_back();
    }
    addresses_.push_front({client, limits_.atOnce, now, {}, 0, {}});
    byClient_.emplace(client, addresses_.begin());
    return addresses_.front();
}

// Many addresses are as many lines, so there is a limit for all: what waits is said later, with its count.
void FailedLogins::tell(Address& address, Time now) {
    if (!minute_ || now - *minute_ >= limits_.silence) {
        minute_ = now;
        lines_ = 0;
        if (forgotten_ > 0) {
            ++lines_;
            say_(fmt::format("failed logins: {} more, from addresses that were too many to tell each",
                             std::exchange(forgotten_, 0)));
        }
    }
    if (lines_ >= limits_.lines) return;
    ++lines_;
    const std::string who = address.client.empty() ? "an unknown address" : address.client;
    const std::uint64_t count = std::exchange(address.untold, 0);
    if (count == 1)
        say_(fmt::format("failed login from {}: {}", who, reason(address.last)));
    else
        say_(fmt::format("{} failed logins from {} since the last line about it; of the last one, {}", count,
                         who, reason(address.last)));
    address.told = now;
}

// Whose count waits and who has not come since: told when anybody else fails. Those that failed longest ago stand last, and he
// who has just failed stands first, and is told by himself.
void FailedLogins::tellOverdue(Time now) {
    constexpr int most = 8;
    int looked = 0;
    for (auto at = addresses_.rbegin(); at != std::prev(addresses_.rend()) && looked < most; ++at, ++looked)
        if (at->untold > 0 && (!at->told || now - *at->told >= limits_.silence)) tell(*at, now);
}

}  // namespace scancast
