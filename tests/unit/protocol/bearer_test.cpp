#include "protocol/bearer.hpp"
#include "protocol/text/base64url.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(Token, IsTrimmedAndOneLongWord) {
    EXPECT_EQ(parseToken(" \tabcdefgh01234567\r\n").value(), "abcdefgh01234567");
    for (const std::string& wrong :
         {std::string(), std::string(" \n"), std::string(15, 'a'), std::string(1025, 'a'),
          std::string("two words of some length"), std::string("t\xc3\xb6ken-of-some-length")}) {
        const auto refused = parseToken(wrong);
        ASSERT_FALSE(refused) << wrong;
        if (wrong.size() > 1) {
            EXPECT_EQ(refused.error().message.find(wrong), std::string::npos) << "a token told to everybody";
        }
    }
}

TEST(Token, OfAnAuthorizationHeader) {
    EXPECT_EQ(tokenOfAuthorization("Bearer abc"), "abc");
    EXPECT_EQ(tokenOfAuthorization("bEARER   a+/=~"), "a+/=~");
    for (const char* wrong : {"", "Bearer", "Bearer ", "Basic YTpi", "Bearerabc", "Bearer a b"})
        EXPECT_FALSE(tokenOfAuthorization(wrong)) << wrong;
}

// The vectors of RFC 4648, 10, in the alphabet of its section 5 and without padding.
TEST(Token, AsASubprotocol) {
    for (const auto& [token, coded] : {std::pair{"f", "Zg"},
                                       {"fo", "Zm8"},
                                       {"foo", "Zm9v"},
                                       {"foob", "Zm9vYg"},
                                       {"fooba", "Zm9vYmE"},
                                       {"foobar", "Zm9vYmFy"},
                                       {"~~~???", "fn5-Pz8_"}}) {
        const std::string protocol = std::string(bearerSubprotocolPrefix) + coded;
        EXPECT_EQ(bearerSubprotocol(token), protocol);
        EXPECT_EQ(tokenOfSubprotocol(protocol), token);
    }
    for (const char* wrong : {"scancast.v1", "base64url.bearer.authorization.",
                              "base64url.bearer.authorization.Zg==", "base64url.bearer.authorization.Z+/v",
                              "base64url.bearer.authorization.CgoK"}) {
        EXPECT_FALSE(tokenOfSubprotocol(wrong)) << wrong;
    }
}

TEST(Base64url, EachTextStandsForItsOwnBytes) {
    std::string bytes;
    for (int i = 0; i < 256; ++i) {
        bytes.push_back(char(i));
        EXPECT_EQ(fromBase64url(base64url(bytes)), bytes) << i;
    }
    EXPECT_EQ(base64url(""), "");
    for (const char* wrong : {"A", "AB=", "AAAAA", "Zh", "Zm9vYh", "Zm 9", "Zm9+", "Zm9/"})
        EXPECT_FALSE(fromBase64url(wrong)) << wrong;
}

}  // namespace
}  // namespace scancast
