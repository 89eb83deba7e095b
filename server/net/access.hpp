// Who may do what: compares the token of a request with those that the server was started with.
//
// Owned by the API; immutable. *Thread safety*: any thread. Keeps only hashes of the tokens, and compares
// them in constant time. Pipeline: router → **access** → api.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"

namespace scancast {

struct AccessTokens {
    std::optional<std::string> user;  ///< of --auth-token-file; without one nobody is asked for a token
    std::optional<std::string>
        admin;  ///< of --admin-token-file; good for everything. Without one nobody administers
};

class Access {
  public:
    explicit Access(const AccessTokens& tokens);

    /// Lets a request through, or answers it: 401 with WWW-Authenticate when a token is missing or wrong, 403
    /// when it is not enough. The page, liveness and readiness need none. A WebSocket may bring its token as
    /// a subprotocol.
    tl::expected<void, HttpResponse> check(const HttpRequest& request, Route route) const;
    /// Whether an answer to this request may be kept for this client only (Cache-Control: private).
    bool isPrivate(const HttpRequest& request) const;

  private:
    using Digest = std::array<std::uint8_t, 32>;
    static Digest digestOf(std::string_view token);
    static bool same(const std::optional<Digest>& known, const Digest& given);

    std::optional<Digest> user_, admin_;
};

}  // namespace scancast
