#include "server/access/token_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <random>

#include "protocol/text/base64url.hpp"
#include "server/access/token_strength.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string firstToken = "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo";
const std::string secondToken = "8f3a1c9e5b7d204f6a8e0c2b4d9f1735";

Expected<std::vector<NamedToken>> tokensOf(const std::string& text) {
    return parseTokens(text, "user", "FILE");
}

TEST(TokenFile, HoldsNamedTokensAndOneWithoutAName) {
    const auto tokens = tokensOf("# who may look\n\n  alice\t" + firstToken + " \r\n   #bob " + firstToken +
                                 "\n" + secondToken);
    ASSERT_TRUE(tokens) << tokens.error().message;
    EXPECT_EQ(*tokens, (std::vector<NamedToken>{{"alice", firstToken}, {"user", secondToken}}));
    EXPECT_EQ(tokensOf(firstToken + "\n")->front(), (NamedToken{"user", firstToken}))
        << "as such files always were";
}

TEST(TokenFile, ErrorsNameTheLineAndNeverAToken) {
    const std::string longName(65, 'n');
    const std::pair<std::string, std::string> wrong[] = {
        {"a " + firstToken + "\na " + secondToken, "FILE:2: a second token of the name \"a\""},
        {firstToken + "\n" + secondToken, "FILE:2: a second token of the name \"user\""},
        {"a " + firstToken + "\n#\nb " + firstToken, "FILE:3: the tokens of \"a\" and \"b\" are the same"},
        {"a b " + firstToken, "FILE:1: a line is NAME TOKEN"},
        {"a/b " + firstToken, "FILE:1: a name has 1 to 64"},
        {longName + " " + firstToken, "FILE:1: a name has 1 to 64"},
        {firstToken + " a", "FILE:1: a token needs at least"},
        {"a t\xc3\xb6ken-" + firstToken, "FILE:1: a token is one word of"},
        {"a letmein-0123456789", "FILE:1: the token \"a\" is too weak"},
        {"# nothing\n\n", "FILE: there is no token in it"},
        {"", "scancast token NAME"},
    };
    for (const auto& [text, part] : wrong) {
        const auto refused = tokensOf(text);
        ASSERT_FALSE(refused) << text;
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(refused.error().message, HasSubstr(part));
        for (const std::string& secret : {firstToken, secondToken, std::string("letmein")})
            EXPECT_THAT(refused.error().message, Not(HasSubstr(secret))) << text;
    }
}

TEST(TokenFile, IsASecretOfItsOwner) {
    const test::TemporaryFolder folder;
    const auto path = folder / "tokens";
    std::ofstream(path) << "alice " << firstToken << "\n";
    ::chmod(path.c_str(), 0644);
    EXPECT_THAT(readTokens(path, "user").error().message, HasSubstr("chmod 600"));
    ::chmod(path.c_str(), 0600);
    EXPECT_EQ(readTokens(path, "user")->front().name, "alice");
    std::ofstream(path) << "alice short\n";
    EXPECT_THAT(readTokens(path, "user").error().message, StartsWith(path.string() + ":1: "));
    EXPECT_EQ(readTokens(folder / "none", "user").error().code, ErrorCode::NotFound);
}

TEST(TokenFile, NewTokensAreStrongAndDiffer) {
    const auto one = newToken(), other = newToken();
    ASSERT_TRUE(one && other);
    EXPECT_NE(*one, *other);
    EXPECT_EQ(fromBase64url(*one)->size(), 32U);
    EXPECT_TRUE(tokensOf("made " + *one));
}

TEST(TokenStrength, WordsRunsAndRepetitionsAreWeak) {
    for (const char* weak :
         {"", "letmein-0123456789", "user-0123456789abcdef", "correcthorsebatterystaple",
          "0123456789abcdef0123456789abcdef", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
          "abababababababababababababababababababababababab", "Passwort-Passwort-Passwort-Passwort-Passwort",
          "q7Rf-2mVq7Rf-2mVq7Rf-2mVq7Rf-2mV", "12345678901234567890123456789012345",
          "qwertyuiopasdfghjklzxcvbnmqwertyuiop",
          "zyxwvutsrqponmlkjihgfedcba9876543210ZYXWVUTSRQPONMLKJIHGFEDCBA",
          "changeme-changeme-changeme-changeme!", "2026-11-25-2026-11-26-2026-11-27"})
        EXPECT_LT(estimatedBits(weak), leastTokenBits) << weak;
    EXPECT_THAT(weaknessText(41.7), HasSubstr("about 41 bits are estimated, and 96 are needed"));
}

// What people make tokens with has 128 bits and more; none of ten thousand may be refused.
TEST(TokenStrength, WhatIsMadeAtRandomPasses) {
    std::mt19937_64 random(20261125);
    const auto bytes = [&](std::size_t count) {
        std::string text;
        for (std::size_t i = 0; i < count; ++i) text.push_back(char(random()));
        return text;
    };
    double leastHex = 1000, leastBase64 = 1000, leastUsual = 1000;
    for (int i = 0; i < 10'000; ++i) {
        std::string hex;
        for (const char c : bytes(16)) {
            hex.push_back("0123456789abcdef"[c >> 4 & 15]);
            hex.push_back("0123456789abcdef"[c & 15]);
        }
        leastHex = std::min(leastHex, estimatedBits(hex));
        leastBase64 = std::min(leastBase64, estimatedBits(base64url(bytes(24))));
        leastUsual = std::min(leastUsual, estimatedBits(base64url(bytes(32))));
    }
    EXPECT_GE(leastHex, leastTokenBits) << "openssl rand -hex 16";
    EXPECT_GE(leastBase64, leastTokenBits) << "openssl rand -base64 24";
    EXPECT_GE(leastUsual, leastTokenBits) << "openssl rand -base64 32";
}

}  // namespace
}  // namespace scancast
