// Where a server listens, as --admin-listen says it. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

struct ListenAddress {
    std::string host = "127.0.0.1";  ///< a name or an address, of version 6 without brackets
    std::uint16_t port = 0;          ///< 0 = any free one
    /// "127.0.0.1:9090", "[::1]:9090".
    std::string text() const;
};

/// HOST:PORT, of version 6 in brackets. InvalidArgument, which names the flag, for anything else: also for a port alone,
/// because whether it is for this machine or for all is not guessed.
Expected<ListenAddress> parseListenAddress(std::string_view text, std::string_view flag);

}  // namespace scancast
