// Who tries tokens that are none: counted for each address, said in the log once a minute, and slowed down. Nobody guesses a
// token (token_strength.hpp), so what is protected is the log and the processor, not the token. That is why failures alone
// count, and a right token is let in whatever its address did before: who shares an address with somebody that tries is not
// locked out by him.
//
// Owned by the API. *Thread safety*: any thread. No clock of its own. Place: access → **failed logins** → 401 or 429.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/base/metrics.hpp"

namespace scancast {

struct FailedLoginLimits {
    double atOnce = 10;                ///< of one address that are answered 401
    std::chrono::seconds another{6};   ///< and then one in so long; beyond, 429
    std::size_t addresses = 4096;      ///< that are remembered; the one that failed longest ago makes room
    std::chrono::seconds silence{60};  ///< between two lines about an address
    int lines = 30;                    ///< in all, within such a time
};

class FailedLogins {
  public:
    using Time = std::chrono::steady_clock::time_point;
    using Say = std::function<void(const std::string& line)>;

    /// `say` gets lines for the log; called under a lock, from any thread.
    explicit FailedLogins(Say say, FailedLoginLimits limits = {}) : say_(std::move(say)), limits_(limits) {}

    /// One more, of this client (IpAddress::client()). How long it shall wait before the next one, where it is over the
    /// limit.
    std::optional<std::chrono::seconds> failed(const std::string& client, LoginFailure why, Time now);
    std::size_t size() const;

  private:
    struct Address {
        std::string client;
        double left = 0;           ///< attempts
        Time counted;              ///< when that was so
        std::optional<Time> told;  ///< when a line was written about it
        std::uint64_t untold = 0;
        LoginFailure last = LoginFailure::Unknown;
    };
    using Addresses = std::list<Address>;  ///< who failed last stands first

    Address& addressOf(const std::string& client, Time now);
    void tell(Address& address, Time now);
    void tellOverdue(Time now);

    const Say say_;
    const FailedLoginLimits limits_;
    mutable std::mutex mutex_;
    Addresses addresses_;
    std::unordered_map<std::string, Addresses::iterator> byClient_;
    std::optional<Time> minute_;   ///< in which lines are counted
    int lines_ = 0;                ///< within it
    std::uint64_t forgotten_ = 0;  ///< failures of which no line told when their address was forgotten
};

}  // namespace scancast
