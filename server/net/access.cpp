#include "server/net/access.hpp"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <utility>

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

Access::Access(const AccessTokens& tokens) : state_(stateOf(tokens, nullptr)) {}

void Access::replace(const AccessTokens& tokens) {
    const std::lock_guard lock(mutex_);
    const auto before = std::exchange(state_, stateOf(tokens, state_.get()));
    const auto& after = state_;
    // After the exchange: who finds his grant withdrawn and comes again is judged by the new tokens.
    for (const Known& old : before->tokens) {
        const bool kept = std::ranges::any_of(
            after->tokens, [&](const Known& known) { return known.standing == old.standing; });
        if (!kept) old.standing->withdrawn = true;
    }
    if (after->users && !before->users) before->anyone->withdrawn = true;
}

std::shared_ptr<Access::State> Access::stateOf(const AccessTokens& tokens, const State* before) {
    auto state = std::make_shared<State>();
    state->users = !tokens.users.empty();
    state->admins = !tokens.admins.empty();
    const bool stillOpen = before != nullptr && (before->users || !state->users);
    state->anyone = stillOpen && !before->anyone->withdrawn ? before->anyone : std::make_shared<Standing>();
    const auto add = [&](const std::vector<NamedToken>& list, IdentityKind kind) {
        for (const NamedToken& one : list) {
            Known known{one.name, kind, digestOf(one.token), std::make_shared<Standing>()};
            if (before != nullptr)
                for (const Known& old : before->tokens)
                    if (old.name == known.name && old.kind == kind && old.digest == known.digest)
                        known.standing = old.standing;
            state->tokens.push_back(std::move(known));
        }
    };
    add(tokens.admins, IdentityKind::Admin);
    add(tokens.users, IdentityKind::User);
    return state;
}

std::shared_ptr<const Access::State> Access::now() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

// Hashes have one length, so that not even a token's length shows in the time that comparing takes.
Access::Digest Access::digestOf(std::string_view token) {
    Digest digest{};
    SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
    return digest;
}

const Access::Known* Access::State::find(std::string_view token) const {
    const Digest given = digestOf(token);
    const Known* found = nullptr;
    for (const Known& known : tokens)
        if (CRYPTO_memcmp(known.digest.data(), given.data(), given.size()) == 0 && found == nullptr)
            found = &known;
    return found;
}

tl::expected<Grant, HttpResponse> Access::check(const HttpRequest& request, Route route) const {
    const Need need = needOf(route, request.method);
    const bool administers = need == Need::Admin;
    const auto state = now();
    const Credentials credentials = credentialsOf(request, route);
    const Known* known = credentials.token ? state->find(*credentials.token) : nullptr;
    const bool admitted = known != nullptr && (!administers || known->kind == IdentityKind::Admin);
    if (admitted) return Grant{{known->name, known->kind}, std::nullopt, known->standing};
    if (need == Need::Nothing) return Grant{};
    if (!administers && !state->users) return Grant{{}, std::nullopt, state->anyone};
    if (administers && !state->admins && !state->users) return tl::unexpected(notAdmin(false));
    if (known != nullptr) return tl::unexpected(notAdmin(state->admins));
    return tl::unexpected(unauthorized(credentials.given));
}

bool Access::isPrivate(const HttpRequest& request) const {
    return request.count("authorization") > 0 && !now()->tokens.empty();
}

}  // namespace scancast
