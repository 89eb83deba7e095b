// Where a server is: the URL that people type, taken apart.
//
// A plain value; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast::client {

struct ServerUrl {
    std::string host;  ///< name or address; an IPv6 address without its brackets
    std::uint16_t port = 80;
    bool tls = false;  ///< https or wss
    /// "127.0.0.1:8080", "[::1]:8080": what the Host header and messages say.
    std::string authority() const;
    bool operator==(const ServerUrl&) const = default;
};

/// `http://HOST[:PORT][/]`, or the same with https, ws or wss. InvalidArgument for what is no URL or names a
/// path.
Expected<ServerUrl> parseServerUrl(std::string_view text);

}  // namespace scancast::client
