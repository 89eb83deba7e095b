#include "server/net/access.hpp"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <utility>

#include "protocol/bearer.hpp"
#include "server/access/guest_token.hpp"

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

/// Where a kind of token is needed that this one is not.
HttpResponse notEnough(Need need, IdentityKind kind, bool adminsExist) {
    const char* why = "This needs the administrator's token.";
    if (kind == IdentityKind::Guest)
        why = "A guest may look at one cloud and at nothing else.";
    else if (need == Need::Admin && !adminsExist)
        why = "This server cannot be administered: it was started without --admin-token-file.";
    return problemResponse(problemOf(403, why));
}

const char* detailOf(std::optional<LoginFailure> failure) {
    if (!failure) return "This server needs an access token: send it as \"Authorization: Bearer TOKEN\".";
    if (*failure == LoginFailure::Expired)
        return "This guest link has expired, or the pass that it gave; as long as the link is valid, opening "
               "it again renews the pass.";
    return "This server does not accept that access token.";
}

HttpResponse unauthorized(std::optional<LoginFailure> failure) {
    HttpResponse response = problemResponse(problemOf(401, detailOf(failure)));
    response.set("WWW-Authenticate", failure ? R"(Bearer realm="scancast", error="invalid_token")"
                                             : R"(Bearer realm="scancast")");
    return response;
}

tl::unexpected<LoginRefusal> refuse(std::optional<LoginFailure> failure) {
    return tl::unexpected(LoginRefusal{unauthorized(failure), failure});
}

constexpr bool isEnough(IdentityKind kind, Need need) {
    return int(kind) >= int(need);
}
static_assert(isEnough(IdentityKind::Guest, Need::Guest) && !isEnough(IdentityKind::Guest, Need::Token) &&
              isEnough(IdentityKind::User, Need::Token) && !isEnough(IdentityKind::User, Need::Admin) &&
              isEnough(IdentityKind::Admin, Need::Admin) && isEnough(IdentityKind::Anyone, Need::Nothing));

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
    before->guests.withdrawMissing(after->guests);
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
    state->guests = GuestKeys(tokens.guestKeys, before != nullptr ? before->guests : GuestKeys());
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

tl::expected<Grant, LoginFailure> Access::State::admit(std::string_view token) const {
    if (const Known* known = find(token))
        return Grant{{known->name, known->kind}, std::nullopt, known->standing};
    if (!isGuestToken(token)) return tl::unexpected(LoginFailure::Unknown);
    return guests.admit(token, std::chrono::system_clock::now());
}

tl::expected<Grant, LoginRefusal> Access::check(const HttpRequest& request, Route route) const {
    const Need need = needOf(route, request.method);
    const auto state = now();
    const Credentials credentials = credentialsOf(request, route);
    std::optional<LoginFailure> failure;
    if (credentials.given) failure = LoginFailure::Malformed;
    if (credentials.token) {
        auto grant = state->admit(*credentials.token);
        if (grant && isEnough(grant->identity.kind, need)) return std::move(*grant);
        if (grant) return tl::unexpected(LoginRefusal{notEnough(need, grant->identity.kind, state->admins)});
        failure = grant.error();
    }
    if (need == Need::Nothing) return Grant{};
    if (need != Need::Admin && !state->users) return Grant{{}, std::nullopt, state->anyone};
    if (!state->admins && !state->users)
        return tl::unexpected(LoginRefusal{notEnough(need, IdentityKind::Anyone, false)});
    return refuse(failure);
}

Expected<GuestLink> Access::guestLink(const std::string& cloud, std::chrono::seconds life) const {
    const auto state = now();
    if (state->guests.empty())
        return fail(ErrorCode::Unsupported,
                    "This server has no guests: it was started without --guest-key-file.");
    return state->guests.link(cloud, life, std::chrono::system_clock::now());
}

tl::expected<GuestPass, LoginRefusal> Access::guestPass(const std::string& linkToken) const {
    auto pass = now()->guests.passFor(linkToken, std::chrono::system_clock::now());
    if (!pass) return refuse(pass.error());
    return std::move(*pass);
}

VisibleClouds visibleTo(const Identity& identity, const Catalog& catalog) {
    return VisibleClouds(catalog, identity.cloud);
}

bool Access::isPrivate(const HttpRequest& request) const {
    return request.count("authorization") > 0 && !now()->tokens.empty();
}

}  // namespace scancast
