#include "server/access/guest_keys.hpp"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "protocol/guests/guest.hpp"
#include "protocol/text/base64url.hpp"
#include "server/access/guest_token.hpp"

namespace scancast {
namespace {

std::int64_t unixSecondsOf(Grant::Time time) {
    return std::chrono::floor<std::chrono::seconds>(time.time_since_epoch()).count();
}

Grant::Time timeOf(std::int64_t seconds) {
    return Grant::Time(std::chrono::seconds(seconds));
}

}  // namespace

GuestKeys::GuestKeys(const std::vector<NamedToken>& keys, const GuestKeys& before) {
    for (const NamedToken& key : keys) {
        const auto old = std::ranges::find(before.keys_, key, &Key::secret);
        keys_.push_back({key, old == before.keys_.end() ? std::make_shared<Standing>() : old->standing});
    }
}

Expected<GuestLink> GuestKeys::link(const std::string& cloud, std::chrono::seconds life,
                                    Grant::Time now) const {
    assert(!keys_.empty() && canBeCloudId(cloud) && life.count() >= std::int64_t(shortestGuestLink) &&
           life.count() <= std::int64_t(longestGuestLink));
    std::array<char, guestIdBytes> id{};
    if (RAND_bytes(reinterpret_cast<unsigned char*>(id.data()), int(id.size())) != 1)
        return fail(ErrorCode::Io, "The system has no random numbers to give; try again.");
    const NamedToken& key = keys_.front().secret;
    const std::int64_t until = unixSecondsOf(now + life);
    return GuestLink{signedToken({key.name, cloud, until, {id.data(), id.size()}, std::nullopt}, key.token),
                     timeOf(until)};
}

tl::expected<GuestPass, LoginFailure> GuestKeys::passFor(std::string_view linkToken, Grant::Time now) const {
    const auto claimed = parseGuestToken(linkToken);
    if (!claimed || claimed->token.expires) return tl::unexpected(LoginFailure::Malformed);
    GuestToken token = claimed->token;
    const auto key = std::ranges::find(keys_, token.key, [](const Key& one) { return one.secret.name; });
    if (key == keys_.end() || !claimed->isSignedWith(key->secret.token))
        return tl::unexpected(LoginFailure::Unknown);
    if (now >= timeOf(token.until)) return tl::unexpected(LoginFailure::Expired);
    token.expires = std::min(token.until, unixSecondsOf(now + guestPassLife));
    return GuestPass{signedToken(token, key->secret.token), token.cloud, timeOf(*token.expires),
                     timeOf(token.until)};
}

tl::expected<Grant, LoginFailure> GuestKeys::admit(std::string_view passToken, Grant::Time now) const {
    const auto claimed = parseGuestToken(passToken);
    if (!claimed || !claimed->token.expires) return tl::unexpected(LoginFailure::Malformed);
    const GuestToken& token = claimed->token;
    const auto key = std::ranges::find(keys_, token.key, [](const Key& one) { return one.secret.name; });
    if (key == keys_.end() || !claimed->isSignedWith(key->secret.token))
        return tl::unexpected(LoginFailure::Unknown);
    if (now >= timeOf(*token.expires) || now >= timeOf(token.until))
        return tl::unexpected(LoginFailure::Expired);
    return Grant{{token.key + "/" + base64url(token.id), IdentityKind::Guest, token.cloud},
                 timeOf(token.until),
                 key->standing};
}

void GuestKeys::withdrawMissing(const GuestKeys& after) const {
    for (const Key& key : keys_)
        if (std::ranges::find(after.keys_, key.secret, &Key::secret) == after.keys_.end())
            key.standing->withdrawn = true;
}

}  // namespace scancast
