// Who may do what: compares the token of a request with those that the server knows, which may be replaced while it serves.
//
// Owned by the API. *Thread safety*: any thread. Keeps only hashes of the tokens, and compares them in constant time.
// Pipeline: router → **access** → api; whoever stays connected keeps the grant (server/access/identity.hpp) and looks at it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/identity.hpp"
#include "server/access/token_file.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"

namespace scancast {

struct AccessTokens {
    std::vector<NamedToken> users{};  ///< of --auth-token-file; without any nobody is asked for a token
    std::vector<NamedToken>
        admins{};  ///< of --admin-token-file; good for everything. Without any nobody administers
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
    tl::expected<Grant, HttpResponse> check(const HttpRequest& request, Route route) const;
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

        /// The one of this token; nullptr where there is none. Takes as long for each token.
        const Known* find(std::string_view token) const;
    };

    static Digest digestOf(std::string_view token);
    static std::shared_ptr<State> stateOf(const AccessTokens& tokens, const State* before);
    std::shared_ptr<const State> now() const;

    mutable std::mutex mutex_;
    std::shared_ptr<const State> state_;
};

}  // namespace scancast
