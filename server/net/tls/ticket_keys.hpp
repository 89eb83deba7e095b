// What seals the tickets by which clients resume a TLS session (RFC 5077, RFC 8446, 2.2): the server keeps nothing of
// them, so there is nothing to bound. Whoever had such a key could read the sessions of TLS 1.2 that it has sealed, so
// a key seals for a time, opens for as long again, and is then overwritten; none is ever written down.
//
// Owned by the context of one certificate: another certificate has other keys, and nobody resumes a session past
// the one that it began with. *Thread safety*: every function may be called from any thread.
#pragma once

#include <openssl/ossl_typ.h>

#include <array>
#include <chrono>
#include <mutex>
#include <optional>
#include <span>

#include "protocol/error.hpp"

namespace scancast {

struct TicketKey {
    std::array<unsigned char, 16> name{};  ///< stands in the clear in each ticket
    std::array<unsigned char, 32> cipher{}, mac{};
    std::chrono::steady_clock::time_point made;
    TicketKey() = default;
    TicketKey(const TicketKey&) = default;
    TicketKey& operator=(const TicketKey&) = default;
    ~TicketKey();  ///< overwrites it
};

class TicketKeys {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// For which a key seals, and for which a ticket is good.
    static constexpr std::chrono::hours life{2};

    /// The key to seal with, which is a new one when that of before is too old. nullopt when the system has no random
    /// bytes: then there are no tickets.
    std::optional<TicketKey> sealing(Time now);
    /// The key that sealed a ticket, as long as it opens.
    std::optional<TicketKey> opening(std::span<const unsigned char, 16> name, Time now);

  private:
    std::mutex mutex_;
    std::optional<TicketKey> current_, previous_;
};

/// From now on the context's tickets are sealed so. Internal when OpenSSL has no memory for it.
Expected<void> sealTicketsOf(SSL_CTX& context);

}  // namespace scancast
