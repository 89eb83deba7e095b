// The keys of --guest-key-file, and what they make and judge: links for guests, and the passes that a page gets for one. A guest
// sees one cloud and changes nothing. Several keys have names, as tokens do: the first signs, all are known, and one that is
// taken away withdraws all links that it signed.
//
// Immutable; a part of Access' state. *Thread safety*: any thread. Nothing is kept of links: time is judged by the system's
// clock, to the second.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/identity.hpp"
#include "server/access/token_file.hpp"
#include "server/base/metrics.hpp"

namespace scancast {

/// A pass lives shorter than its link, and is renewed with that.
inline constexpr std::chrono::seconds guestPassLife{std::chrono::hours(1)};

struct GuestLink {
    std::string token;
    Grant::Time until;
};

struct GuestPass {
    std::string token;
    std::string cloud;
    Grant::Time expires;  ///< of the pass
    Grant::Time until;    ///< of the link
};

class GuestKeys {
  public:
    GuestKeys() = default;
    /// Keys that were there before, by name and secret, keep their standing.
    GuestKeys(const std::vector<NamedToken>& keys, const GuestKeys& before);

    bool empty() const { return keys_.empty(); }
    /// Needs a key, an id that can be a cloud's and a lifetime within the limits (protocol/guests/guest.hpp). Io without random numbers.
    Expected<GuestLink> link(const std::string& cloud, std::chrono::seconds life, Grant::Time now) const;
    /// For a link's token.
    tl::expected<GuestPass, LoginFailure> passFor(std::string_view linkToken, Grant::Time now) const;
    /// Of a pass.
    tl::expected<Grant, LoginFailure> admit(std::string_view passToken, Grant::Time now) const;
    /// Those of these keys that are not among `after`.
    void withdrawMissing(const GuestKeys& after) const;

  private:
    struct Key {
        NamedToken secret;
        std::shared_ptr<Standing> standing;
    };
    std::vector<Key> keys_;
};

}  // namespace scancast
