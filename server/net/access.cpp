#include "server/net/access.hpp"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include "protocol/bearer.hpp"

namespace scancast {
namespace {

struct Credentials {
    bool given = false;
    std::optional<std::string> token;  ///< empty when what was given is no token
};

Credentials credentialsOf(const HttpRequest& request, Route route) {
    if (request.count("authorization") > 0) {
        if (request.count("authorization") > 1) return {true, std::nullopt};
        return {true, tokenOfAuthorization(request.header("authorization"))};
    }
    if (route != Route::Stream) return {};
    const std::string offered = request.header("sec-websocket-protocol");
    std::string_view rest = offered;
    while (!rest.empty()) {
        const auto comma = rest.find(',');
        std::string_view one = rest.substr(0, comma);
        rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
        while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
        while (!one.empty() && one.back() == ' ') one.remove_suffix(1);
        if (one.starts_with(bearerSubprotocolPrefix)) return {true, tokenOfSubprotocol(one)};
    }
    return {};
}

HttpResponse notAdmin(bool possible) {
    return problemResponse(problemOf(403, possible ? "This needs the administrator's token."
                                                   : "Nobody administers this server: it was started without "
                                                     "--admin-token-file."));
}

HttpResponse unauthorized(bool given) {
    HttpResponse response =
        problemResponse(problemOf(401, given ? "The access token is not one of this server's."
                                             : "This server asks for an access token: send it as "
                                               "\"Authorization: Bearer TOKEN\"."));
    response.set("WWW-Authenticate",
                 given ? R"(Bearer realm="scancast", error="invalid_token")" : R"(Bearer realm="scancast")");
    return response;
}

}  // namespace

Access::Access(const AccessTokens& tokens) {
    if (tokens.user) user_ = digestOf(*tokens.user);
    if (tokens.admin) admin_ = digestOf(*tokens.admin);
}

// Hashes have one length, so that not even a token's length shows in the time that comparing takes.
Access::Digest Access::digestOf(std::string_view token) {
    Digest digest{};
    SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
    return digest;
}

bool Access::same(const std::optional<Digest>& known, const Digest& given) {
    return known && CRYPTO_memcmp(known->data(), given.data(), given.size()) == 0;
}

tl::expected<void, HttpResponse> Access::check(const HttpRequest& request, Route route) const {
    const Need need = needOf(route, request.method);
    const bool administers = need == Need::Admin;
    if (need == Need::Nothing || (!administers && !user_)) return {};
    if (administers && !admin_ && !user_) return tl::unexpected(notAdmin(false));
    const Credentials credentials = credentialsOf(request, route);
    if (!credentials.token) return tl::unexpected(unauthorized(credentials.given));
    const Digest given = digestOf(*credentials.token);
    if (same(admin_, given)) return {};
    if (same(user_, given)) {
        if (!administers) return {};
        return tl::unexpected(notAdmin(admin_.has_value()));
    }
    return tl::unexpected(unauthorized(true));
}

bool Access::isPrivate(const HttpRequest& request) const {
    return (user_ || admin_) && request.count("authorization") > 0;
}

}  // namespace scancast
