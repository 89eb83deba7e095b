// A guest's link, as a server's administrator passes it on: https://scans.example.org/#guest=TOKEN lets a client without a token
// look at one cloud for a while. What is behind the # is exchanged for a pass, which is then the client's token.
//
// Free functions; any thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "client/cpp/credentials.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"

namespace scancast::client {

/// Whether this is a link of a guest, and no server's plain address.
bool isGuestLink(std::string_view text);

struct GuestEntry {
    ServerUrl url;
    Credentials credentials;  ///< with the pass for a token
    std::string cloud;        ///< the only one that there is for the guest
    std::chrono::seconds
        expires;  ///< of the pass, from now: enter anew before, as long as the link lives. Streams go on to its end
    /// Whether points and elevations are for guests, too; an older server says that only where it refuses them.
    bool mayExport = true;
};

/// Asks the server for a pass; blocks until the answer or the deadline. `authority` as in Credentials. Errors: InvalidArgument
/// for what is no such link - never with the token -, those of the network, what the server refuses with, Malformed.
Expected<GuestEntry> enterAsGuest(std::string_view link, const Timeouts& timeouts = {},
                                  const std::filesystem::path& authority = {});

}  // namespace scancast::client
