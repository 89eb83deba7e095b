// Whom a request is counted for. A proxy stands between: it is the peer, and tells in Forwarded (RFC 7239) or
// X-Forwarded-For who asked it. Anybody can write these headers, so they are believed of those proxies alone that
// --trusted-proxy names, and then only as far as they go from one of them to the next.
//
// Immutable; owned by the server. Pure functions of header values, outside bytes; any thread.
// Pipeline: http connection → **trusted proxies** → connection register, price of pictures.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/net/api/http_message.hpp"
#include "server/net/clients/ip_address.hpp"

namespace scancast {

/// Whom a connection, or a request, is counted for.
struct CountedClient {
    std::string client;   ///< an address, or a network of version 6; empty = not known
    bool limited = true;  ///< its connections are counted against what one address may have
    bool operator==(const CountedClient&) const = default;
};

class TrustedProxies {
  public:
    /// Ranges of addresses, as --trusted-proxy gives them; an error says which is none.
    static Expected<TrustedProxies> parse(std::span<const std::string> ranges);

    bool trusts(const IpAddress& address) const;
    /// The rightmost address in what a trusted peer says that is not a trusted proxy itself; the leftmost, when all are.
    /// The peer's own where it says nothing, `unknown` or an invented name (not limited: it hides its clients, or asks
    /// for itself); and where what it says is malformed, or Forwarded and X-Forwarded-For disagree, one of which is the
    /// client's own then (limited: a client may have brought that about). Never an error. Of any other peer its
    /// address, whatever the headers say.
    CountedClient clientOf(const HttpRequest& request, const IpAddress& peer) const;

  private:
    std::vector<AddressRange> ranges_;
};

}  // namespace scancast
