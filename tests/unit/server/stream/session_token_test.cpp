#include "server/stream/session_token.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

const SessionToken sample{"s0123456789abcdef01234567", 3, 1'800'000'000, ownerDigest("anna"), "twelve bytes"};

TEST(SessionTokens, AreReadAsTheyWereWritten) {
    const std::string text = signedToken(sample, "key");
    const auto claimed = parseSessionToken(text);
    ASSERT_TRUE(claimed) << text;
    EXPECT_EQ(claimed->token, sample);
    EXPECT_TRUE(claimed->isSignedWith("key"));
    EXPECT_FALSE(claimed->isSignedWith("other"));
}

TEST(SessionTokens, NothingElseIsOne) {
    const std::string text = signedToken(sample, "key");
    const auto with = [](SessionToken token, auto change) {
        change(token);
        return signedToken(token, "key");
    };
    for (const std::string& wrong :
         {std::string(), text.substr(1), text + ".", text + "=", "scg1" + text.substr(4),
          text.substr(0, text.rfind('.')), std::string(10'000, 'a'), "scs1." + std::string(5'000, '.'),
          with(sample, [](SessionToken& token) { token.session = "../etc"; }),
          with(sample, [](SessionToken& token) { token.session = ""; }),
          with(sample, [](SessionToken& token) { token.session = std::string(65, 'a'); }),
          with(sample, [](SessionToken& token) { token.turn = 0; }),
          with(sample, [](SessionToken& token) { token.turn = lastTurn + 1; }),
          with(sample, [](SessionToken& token) { token.expires = -1; }),
          with(sample, [](SessionToken& token) { token.owner = "short"; }),
          with(sample, [](SessionToken& token) { token.nonce.clear(); })})
        EXPECT_FALSE(parseSessionToken(wrong)) << wrong.substr(0, 80);
}

}  // namespace
}  // namespace scancast
