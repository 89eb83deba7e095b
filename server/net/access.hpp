// Who may do what: compares the token of a request with those that the server knows, which may be replaced while it serves.
//
// Owned by the API. *Thread safety*: any thread. Keeps only hashes of the tokens, and compares them in constant time.
// Pipeline: router → **access** → api; whoever stays connected keeps the grant (server/access/identity.hpp) and looks at it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/guest_keys.hpp"
#include "server/access/identity.hpp"
#include "server/access/token_file.hpp"
#include "server/base/metrics.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"

namespace scancast {

struct AccessTokens {
    /// Of --auth-token-file; without any nobody is asked for a token.
    std::vector<NamedToken> users{};
    /// Of --admin-token-file; good for everything. Without any nobody administers.
    std::vector<NamedToken> admins{};
    /// Of --guest-key-file; without any there are no guests.
    std::vector<NamedToken> guestKeys{};
    /// Of --session-key-file; without any, sessions go on at this server alone.
    std::vector<NamedToken> sessionKeys{};
};

/// The clouds that there are for somebody: of a guest, one.
VisibleClouds visibleTo(const Identity& identity, const Catalog& catalog);

/// The answer to who is not let in.
struct LoginRefusal {
    HttpResponse response;
    std::optional<LoginFailure>
        failure{};  ///< of the token that was sent; empty where there was none, or a sound one
};

class Access {
  public:
    explicit Access(const AccessTokens& tokens);

    /// Other tokens, from now on. Grants by those that are not among them - by name, token and what they are good for -
    /// are withdrawn; where a token is needed that was not, so are those of who had none. The others hold on.
    void replace(const AccessTokens& tokens);

    /// Lets a request through, and says whose it is; or answers it: 401 with WWW-Authenticate when a token is missing or
    /// wrong, 403 when it is not enough. The page, liveness and readiness need none. A WebSocket may bring its token as a
    /// subprotocol.
    tl::expected<Grant, LoginRefusal> check(const HttpRequest& request, Route route) const;
    /// A link to that cloud for a guest. Unsupported where there is no key to sign it.
    Expected<GuestLink> guestLink(const std::string& cloud, std::chrono::seconds life) const;
    /// What a guest's page uses as its token from now on, for the token of a link; 401 for what is none, and for one whose
    /// time is over.
    tl::expected<GuestPass, LoginRefusal> guestPass(const std::string& linkToken) const;
    /// Whether an answer to this request may be kept for this client only (Cache-Control: private).
    bool isPrivate(const HttpRequest& request) const;

  private:
    using Digest = std::array<std::uint8_t, 32>;
    struct Known {
        std::string name;
        IdentityKind kind;
        Digest digest;
        std::shared_ptr<Standing> standing;
    };
    /// Replaced as a whole; who works with an old one finishes with that.
    struct State {
        std::vector<Known> tokens;
        bool users = false, admins = false;  ///< there are any
        std::shared_ptr<Standing> anyone;    ///< who needed no token
        GuestKeys guests;

        /// The one of this token; nullptr where there is none. Takes as long for each token.
        const Known* find(std::string_view token) const;
        /// Whoever comes with it.
        tl::expected<Grant, LoginFailure> admit(std::string_view token) const;
    };

    static Digest digestOf(std::string_view token);
    static std::shared_ptr<State> stateOf(const AccessTokens& tokens, const State* before);
    std::shared_ptr<const State> now() const;

    mutable std::mutex mutex_;
    std::shared_ptr<const State> state_;
};

}  // namespace scancast
