#include "server/access/guest_keys.hpp"

#include <gtest/gtest.h>

#include "protocol/bearer.hpp"
#include "protocol/guests/guest.hpp"
#include "protocol/text/base64url.hpp"
#include "server/access/guest_token.hpp"

namespace scancast {
namespace {

using std::chrono::seconds;

const NamedToken guestsKey{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"},
    laterKey{"more.guests", "Zk3_tP8wQd-1HvNx5yMjR2bFsLg7cUaE"};
const Grant::Time atNoon{seconds(1'800'000'000)};

GuestToken aLink() {
    return {"guests", "town", 1'800'003'600, "0123456789ab", std::nullopt};
}

// Computed by an implementation that is not ours: Python's hmac.
TEST(GuestToken, IsWhatItsHeaderSays) {
    EXPECT_EQ(signedToken(aLink(), "secret"),
              "scg1.Z3Vlc3Rz.dG93bg.1800003600.MDEyMzQ1Njc4OWFi._smd9LPkVUe9oi9-v7MW4rqXV9oLxeBz1NVammWXna0");
    GuestToken pass = aLink();
    pass.expires = 1'800'000'060;
    EXPECT_EQ(signedToken(pass, "secret"),
              "scp1.Z3Vlc3Rz.dG93bg.1800003600.MDEyMzQ1Njc4OWFi.1800000060.G_Fs4QgJv3mhFGJTCzX_Gyc0ih8_"
              "H0hNIxCFBSe8Rno");
}

TEST(GuestToken, IsReadAsItWasWritten) {
    GuestToken pass = aLink();
    pass.expires = 1'800'000'060;
    for (const GuestToken& token : {aLink(), pass}) {
        const std::string text = signedToken(token, "secret");
        EXPECT_LT(text.size(), longestToken);
        EXPECT_EQ(tokenOfAuthorization("Bearer " + text), text);
        const auto claimed = parseGuestToken(text);
        ASSERT_TRUE(claimed) << text;
        EXPECT_EQ(claimed->token, token);
        EXPECT_TRUE(claimed->isSignedWith("secret"));
        EXPECT_FALSE(claimed->isSignedWith("secreT"));
        EXPECT_FALSE(claimed->isSignedWith(""));
    }
}

TEST(GuestToken, NotOneCharacterMayBeAnother) {
    const std::string text = signedToken(aLink(), "secret");
    for (std::size_t at = 0; at < text.size(); ++at)
        for (const char c : {'A', '0', '.', 'x'}) {
            if (text[at] == c) continue;
            std::string changed = text;
            changed[at] = c;
            const auto claimed = parseGuestToken(changed);
            EXPECT_FALSE(claimed && claimed->isSignedWith("secret")) << changed;
        }
}

TEST(GuestToken, OthersAreNone) {
    const auto of = [](const std::string& k, const std::string& cloud, const std::string& until,
                       const std::string& id, const std::string& signature) {
        return "scg1." + base64url(k) + "." + base64url(cloud) + "." + until + "." + base64url(id) + "." +
               base64url(signature);
    };
    const std::string id(12, 'i'), sound(32, 's');
    ASSERT_TRUE(parseGuestToken(of("k", "town", "1800000000", id, sound)));
    for (const std::string& wrong : {std::string(),
                                     std::string("scg1."),
                                     std::string("scg1......"),
                                     of("", "town", "1", id, sound),
                                     of("k/", "town", "1", id, sound),
                                     of("k", "", "1", id, sound),
                                     of("k", "../town", "1", id, sound),
                                     of("k", std::string(81, 'c'), "1", id, sound),
                                     of("k", "town", "01", id, sound),
                                     of("k", "town", "-1", id, sound),
                                     of("k", "town", "0", id, sound),
                                     of("k", "town", "9000000001", id, sound),
                                     of("k", "town", "1e9", id, sound),
                                     of("k", "town", "", id, sound),
                                     of("k", "town", "1", "short", sound),
                                     of("k", "town", "1", id, sound + "s"),
                                     of("k", "town", "1", id, sound) + ".",
                                     of("k", "town", "1", id, sound) + " ",
                                     std::string(2000, 'a'),
                                     "scp1" + of("k", "town", "1", id, sound).substr(4)})
        EXPECT_FALSE(parseGuestToken(wrong)) << wrong;
}

TEST(GuestKeys, ALinkIsExchangedForPassesWhileItLives) {
    const GuestKeys keys({guestsKey, laterKey}, {});
    const auto link = keys.link("town", seconds(7200), atNoon);
    ASSERT_TRUE(link);
    EXPECT_EQ(link->until, atNoon + seconds(7200));
    const auto pass = keys.passFor(link->token, atNoon + seconds(10));
    ASSERT_TRUE(pass);
    EXPECT_EQ(pass->cloud, "town");
    EXPECT_EQ(pass->expires, atNoon + seconds(10) + guestPassLife);
    EXPECT_EQ(pass->until, link->until);
    const auto grant = keys.admit(pass->token, atNoon + seconds(11));
    ASSERT_TRUE(grant);
    EXPECT_EQ(grant->identity.kind, IdentityKind::Guest);
    EXPECT_EQ(grant->identity.cloud, "town");
    EXPECT_EQ(grant->identity.name.substr(0, 7), "guests/");
    EXPECT_EQ(grant->until, link->until) << "what it opened lasts as long as the link";
    EXPECT_EQ(grant->ended(link->until - seconds(1)), nullptr);
    EXPECT_NE(grant->ended(link->until), nullptr);

    EXPECT_EQ(keys.admit(pass->token, pass->expires - seconds(1))->identity, grant->identity);
    EXPECT_EQ(keys.admit(pass->token, pass->expires).error(), LoginFailure::Expired);
    const auto last = keys.passFor(link->token, link->until - seconds(1));
    ASSERT_TRUE(last);
    EXPECT_EQ(last->expires, link->until) << "no pass outlives its link";
    EXPECT_EQ(keys.passFor(link->token, link->until).error(), LoginFailure::Expired);
}

TEST(GuestKeys, LinksAndPassesAreNotTakenForEachOther) {
    const GuestKeys keys({guestsKey}, {});
    const auto link = keys.link("town", seconds(7200), atNoon);
    const auto pass = keys.passFor(link->token, atNoon);
    EXPECT_EQ(keys.admit(link->token, atNoon).error(), LoginFailure::Malformed);
    EXPECT_EQ(keys.passFor(pass->token, atNoon).error(), LoginFailure::Malformed);
    // A pass cut down to the shape of a link, signature and all.
    const auto claimed = parseGuestToken(pass->token);
    GuestToken cut = claimed->token;
    cut.expires.reset();
    const std::string text = signedToken(cut, "whatever");
    const std::string forged = text.substr(0, text.rfind('.') + 1) + base64url(claimed->signature);
    EXPECT_EQ(keys.passFor(forged, atNoon).error(), LoginFailure::Unknown);
}

TEST(GuestKeys, AKeyThatIsTakenAwayWithdrawsWhatItSigned) {
    const GuestKeys before({guestsKey, laterKey}, {});
    const auto link = before.link("town", seconds(7200), atNoon);
    const auto pass = before.passFor(link->token, atNoon);
    const auto grant = before.admit(pass->token, atNoon);
    ASSERT_TRUE(grant);

    const GuestKeys both({laterKey, guestsKey}, before);
    before.withdrawMissing(both);
    EXPECT_EQ(grant->ended(atNoon), nullptr) << "the order says only which one signs";
    EXPECT_TRUE(both.admit(pass->token, atNoon));

    const GuestKeys after({laterKey, {guestsKey.name, guestsKey.token + "x"}}, both);
    both.withdrawMissing(after);
    EXPECT_NE(grant->ended(atNoon), nullptr);
    EXPECT_EQ(after.admit(pass->token, atNoon).error(), LoginFailure::Unknown);
    EXPECT_EQ(after.passFor(link->token, atNoon).error(), LoginFailure::Unknown);
    EXPECT_EQ(GuestKeys().passFor(link->token, atNoon).error(), LoginFailure::Unknown);
}

}  // namespace
}  // namespace scancast
