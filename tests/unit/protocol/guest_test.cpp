#include "protocol/guests/guest.hpp"

#include <gmock/gmock.h>

namespace scancast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Guest, ALinkIsAskedForWithCloudAndTime) {
    EXPECT_EQ(parseGuestLinkRequest(R"({"cloud": "town", "expiresInSeconds": 60})").value(),
              (GuestLinkRequest{"town", 60}));
    for (const auto& [text, field] :
         {std::pair(R"({"expiresInSeconds": 60})", "cloud"),
          {R"({"cloud": "town"})", "expiresInSeconds"},
          {R"({"cloud": "town", "expiresInSeconds": 59})", "expiresInSeconds"},
          {R"({"cloud": "town", "expiresInSeconds": 31622401})", "expiresInSeconds"},
          {R"({"cloud": "town", "expiresInSeconds": "7d"})", "expiresInSeconds"},
          {R"({"cloud": "town", "expiresInSeconds": 60, "admin": true})", "admin"}}) {
        const auto refused = parseGuestLinkRequest(text);
        ASSERT_FALSE(refused) << text;
        EXPECT_EQ(refused.error().field, field);
    }
}

TEST(Guest, ATokenThatIsNoneIsNotRepeated) {
    EXPECT_EQ(parseGuestSessionRequest(R"({"token": "scg1.a.b"})").value(), "scg1.a.b");
    for (const char* text : {R"({"token": "scg1.secret)", R"({"token": ["scg1.secret"]})", "scg1.secret",
                             R"({"guest": "scg1.secret"})", R"({"token": "a", "more": "scg1.secret"})"}) {
        const auto refused = parseGuestSessionRequest(text);
        ASSERT_FALSE(refused) << text;
        EXPECT_THAT(refused.error().message, Not(HasSubstr("secret")));
    }
    EXPECT_FALSE(parseGuestSessionRequest("{\"token\": \"" + std::string(1025, 'a') + "\"}"));
}

TEST(Guest, AnAddressIsTakenApart) {
    const auto found = guestAddress("https://scans.example.org/#method=ewa&guest=scg1.a-b_c&eye=1,2,3");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->address, "https://scans.example.org/");
    EXPECT_EQ(found->token, "scg1.a-b_c");
    EXPECT_EQ(guestAddress("http://h:1" + guestPath("t"))->token, "t");
    for (const char* none :
         {"", "#", "http://h/", "http://h/?guest=a", "http://h/#cloud=guest=a", "http://h/#myguest=a"})
        EXPECT_FALSE(guestAddress(none)) << none;
}

TEST(Guest, TimesAreWrittenWithAUnit) {
    EXPECT_EQ(parseGuestTime("90s").value(), 90U);
    EXPECT_EQ(parseGuestTime("30m").value(), 1800U);
    EXPECT_EQ(parseGuestTime("12h").value(), 43200U);
    EXPECT_EQ(parseGuestTime("366d").value(), longestGuestLink);
    for (const char* wrong : {"", "d", "7", "7D", "7 d", "-7d", "1.5h", "59s", "367d", "0d",
                              "99999999999999999999d", "18446744073709551615d", "7d "})
        EXPECT_FALSE(parseGuestTime(wrong)) << wrong;
}

TEST(Guest, MomentsAreUtc) {
    EXPECT_EQ(utcText(std::chrono::system_clock::time_point(std::chrono::seconds(1'800'000'000))),
              "2027-01-15T08:00:00Z");
}

}  // namespace
}  // namespace scancast
