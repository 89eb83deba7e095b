// What is said about guests over HTTP: the bodies of POST /guest-links and POST /guest-session, their answers, and a link as
// people pass it on. Pure functions of outside bytes; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// s that a guest's link may live: from a minute to 366 days.
inline constexpr std::uint64_t shortestGuestLink = 60, longestGuestLink = std::uint64_t(366) * 24 * 3600;

/// Of an administrator: a link to that cloud, please.
struct GuestLinkRequest {
    std::string cloud;
    std::uint64_t seconds = 0;
    bool operator==(const GuestLinkRequest&) const = default;
};

/// Malformed when the text is no JSON; InvalidArgument, with the field, for everything else.
Expected<GuestLinkRequest> parseGuestLinkRequest(std::string_view text);
/// The token of a link, of {"token": …}. The same errors, which never hold what was sent.
Expected<std::string> parseGuestSessionRequest(std::string_view text);

/// "2026-11-25T02:45:00Z".
std::string utcText(std::chrono::system_clock::time_point time);

/// Behind the # of an address, which no browser and no client of ours sends anywhere: "guest=TOKEN".
inline constexpr std::string_view guestFragmentWord = "guest=";
/// "/#guest=TOKEN", behind a server's address without a slash at its end.
std::string guestPath(std::string_view token);
/// The token in an address, and the address without what stands behind its #; nullopt where it has none.
struct GuestAddress {
    std::string address, token;
};
std::optional<GuestAddress> guestAddress(std::string_view url);

/// "90s", "30m", "12h", "7d" as seconds; InvalidArgument for what is none, or outside of a link's limits.
Expected<std::uint64_t> parseGuestTime(std::string_view text);

}  // namespace scancast
