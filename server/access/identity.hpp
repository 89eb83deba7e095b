// Who asks, as far as a token says it, and for how long that holds.
//
// Plain values, copied with each request and kept by each stream. *Thread safety*: any thread. Place: access → **grant** →
// api, connections.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace scancast {

/// Each may do what those before it may.
enum class IdentityKind : std::uint8_t {
    Anyone,  ///< no token was needed, and none of this server's was shown
    Guest,   ///< of one cloud, to look at
    User,
    Admin,
};

struct Identity {
    std::string name{};  ///< of the token, or of a guest's link; never the token; empty of anyone
    IdentityKind kind = IdentityKind::Anyone;
    std::string cloud{};  ///< of a guest: the only one that there is for him
    bool operator==(const Identity&) const = default;
};

/// What lets somebody in, shared by all whom it let in: withdrawn once, when the server is told other tokens.
struct Standing {
    std::atomic<bool> withdrawn{false};
};

/// A request's permission, and a stream's as long as it lasts.
struct Grant {
    using Time = std::chrono::system_clock::time_point;

    Identity identity{};
    std::optional<Time> until{};                 ///< that is the end of it; of tokens there is none
    std::shared_ptr<const Standing> standing{};  ///< empty: never withdrawn

    /// Why nothing more is owed to who came by it, as a sentence; nullptr while it holds.
    const char* ended(Time now) const {
        if (standing && standing->withdrawn)
            return "The token that this began with is no longer one of this server's.";
        if (until && now >= *until) return "The time of this guest's link is over.";
        return nullptr;
    }
};

}  // namespace scancast
