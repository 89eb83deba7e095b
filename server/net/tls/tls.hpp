// How the server speaks TLS, and the certificate that it shows: read and checked before it listens, and again when it is
// told to reload. Free functions; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "protocol/error.hpp"

namespace boost::asio::ssl {
class context;
}

namespace scancast {

struct TlsFiles {
    std::filesystem::path
        certificate;            ///< PEM: the server's own, then those between it and a known authority
    std::filesystem::path key;  ///< PEM, without a pass phrase
    bool given() const { return !certificate.empty() || !key.empty(); }
};

/// What connections that come from now on are given. Immutable.
struct ServerTls {
    std::shared_ptr<boost::asio::ssl::context> context;
    std::chrono::system_clock::time_point expires;  ///< the first certificate of the chain to do so
    std::string digest;                             ///< of the chain: another one has another
};

/// TLS 1.3, and 1.2 with forward secrecy and authenticated encryption alone; sessions are resumed by tickets
/// (ticket_keys.hpp). Errors name the file and what is wrong: missing, no PEM, another certificate's key, a key that
/// others can read, a certificate that has expired or is not valid yet.
Expected<ServerTls> openTls(const TlsFiles& files);

/// Below this, somebody should renew it.
inline constexpr std::chrono::hours renewalTime{14 * 24};
/// A sentence for the log when the chain ends within renewalTime of `now`, or has ended; else empty.
std::string expiryWarning(const ServerTls& tls, const std::filesystem::path& certificate,
                          std::chrono::system_clock::time_point now);
/// "2026-12-09 08:30 UTC".
std::string dateText(std::chrono::system_clock::time_point time);

/// The value of Strict-Transport-Security: browsers come by https alone for that long. Of this host, not of others beneath
/// its name, which may have no TLS. Empty for 0.
std::string strictTransport(std::uint64_t seconds);

}  // namespace scancast
