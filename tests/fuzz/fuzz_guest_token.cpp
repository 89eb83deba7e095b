// Guests' tokens, as anybody who can connect may send them, and the JSON that brings a link's.
#include <cstddef>
#include <cstdint>
#include <string>

#include "protocol/guests/guest.hpp"
#include "server/access/guest_keys.hpp"
#include "server/access/guest_token.hpp"
#include "tests/fuzz/require.hpp"

using namespace scancast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::string key = "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo";
    static const GuestKeys keys({{"guests", key}}, {});
    const std::string text(reinterpret_cast<const char*>(data), size);
    const Grant::Time now{std::chrono::seconds(1'800'000'000)};
    if (const auto claimed = parseGuestToken(text)) {
        // One token has one spelling.
        const std::string again = signedToken(claimed->token, key);
        require(again.substr(0, again.rfind('.')) == claimed->text);
        require(claimed->isSignedWith(key) == (again == text));
        require(canBeCloudId(claimed->token.cloud));
    }
    // Whom it lets in has been given a link: only what was signed with the key is believed.
    if (const auto grant = keys.admit(text, now))
        require(parseGuestToken(text)->isSignedWith(key) && *grant->until > now &&
                !grant->identity.cloud.empty());
    if (const auto pass = keys.passFor(text, now))
        require(keys.admit(pass->token, now).has_value() && pass->expires <= pass->until);
    if (const auto token = parseGuestSessionRequest(text)) require(token->size() <= 1024);
    if (const auto asked = parseGuestLinkRequest(text))
        require(asked->seconds >= shortestGuestLink && asked->seconds <= longestGuestLink);
    if (const auto address = guestAddress(text)) require(text.starts_with(address->address + "#"));
    if (const auto seconds = parseGuestTime(text))
        require(*seconds >= shortestGuestLink && *seconds <= longestGuestLink);
    return 0;
}
