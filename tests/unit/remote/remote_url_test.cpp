#include "remote/remote_url.hpp"

#include <gmock/gmock.h>

#include "remote/access.hpp"

namespace scancast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(RemoteUrlTest, whatIsShownHasNoQuery) {
    const auto url =
        RemoteUrl::parse("HTTPS://Storage.example.org:8443/a/Old%20town.scan?X-Amz-Signature=secret");
    ASSERT_TRUE(url) << url.error().message;
    EXPECT_EQ(url->whole(), "https://storage.example.org:8443/a/Old%20town.scan?X-Amz-Signature=secret");
    EXPECT_EQ(url->shown(), "https://storage.example.org:8443/a/Old%20town.scan");
    EXPECT_EQ(url->identity(), url->shown()) << "signed anew, it is the same object";
    EXPECT_EQ(url->name(), "Old town.scan");
    EXPECT_NE(RemoteUrl::parse("https://a/b?id=1")->identity(),
              RemoteUrl::parse("https://a/b?id=2")->identity());
    EXPECT_EQ(shownArgument("https://user:pass@host/x.scan?key=secret#y"), "https://host/x.scan");
    EXPECT_EQ(shownArgument("what?.las"), "what?.las");
    EXPECT_EQ(shownArgument("ftp://user:p/a?s@s@host/x?key=secret"), "ftp://host/x");
    EXPECT_EQ(shownArgument("ftp://host/x?key=secret"), "ftp://host/x");
}

TEST(RemoteUrlTest, refusesWithoutTellingSecrets) {
    for (const std::string wrong : {"https://",
                                    "https:///x",
                                    "https://host",
                                    "https://host/",
                                    "https://host/folder/",
                                    "https://:80/x",
                                    "https://secret:secret@host/x",
                                    "https://host/x#secret",
                                    "https://host/a b?secret",
                                    "https://host/\x01",
                                    "https://ho\"st/x",
                                    "https://host/\xc3\xa4",
                                    "s3://",
                                    "s3://b/k",
                                    "s3://bucket",
                                    "s3://bucket/",
                                    "s3://bucket/folder/",
                                    "s3://.bucket/k",
                                    "s3://bu/cket",
                                    "s3://bu@cket/k",
                                    "ftp://host/x",
                                    "file:///x"}) {
        const auto url = RemoteUrl::parse(wrong);
        ASSERT_FALSE(url) << wrong;
        EXPECT_EQ(url.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(url.error().message, Not(HasSubstr("secret")));
    }
    EXPECT_FALSE(RemoteUrl::parse("https://host/" + std::string(9000, 'x')));
}

TEST(RemoteUrlTest, onlyUrlsAreUrls) {
    EXPECT_TRUE(isRemoteUrl("s3://bucket/key"));
    EXPECT_TRUE(isRemoteUrl("HTTP://x"));
    for (const char* file :
         {"town.scan", "http:/x", "file:///etc/passwd", "ftp://x/y", "https", "./https://x"})
        EXPECT_FALSE(isRemoteUrl(file)) << file;
}

TEST(RemoteAccessTest, asksWhereTheEnvironmentSays) {
    const auto town = *RemoteUrl::parse("s3://scans/a/old town+1.scan");
    EXPECT_EQ(accessTo(town, {})->url, "https://scans.s3.us-east-1.amazonaws.com/a/old%20town%2B1.scan");
    EXPECT_EQ(accessTo(town, {.region = "eu-central-1"})->url,
              "https://scans.s3.eu-central-1.amazonaws.com/a/old%20town%2B1.scan");
    EXPECT_EQ(accessTo(town, {.endpoint = "http://localhost:4568/"})->url,
              "http://localhost:4568/scans/a/old%20town%2B1.scan");
    EXPECT_EQ(accessTo(*RemoteUrl::parse("s3://sca.ns/x"), {})->url,
              "https://s3.us-east-1.amazonaws.com/sca.ns/x");
    for (const char* wrong : {"localhost", "ftp://x", "http://u:p@x", "http://x/?q", "s3://abc"})
        EXPECT_FALSE(accessTo(town, {.endpoint = wrong})) << wrong;
    EXPECT_FALSE(accessTo(town, {.region = "eu central"}));
}

TEST(RemoteAccessTest, signsForS3AloneAndOnlyWithCredentials) {
    RemoteEnvironment environment{.keyId = "AKID", .secret = "topsecret", .sessionToken = "token"};
    const auto town = *RemoteUrl::parse("s3://scans/town.scan");
    EXPECT_TRUE(accessTo(town, {})->signing.empty());
    const auto access = accessTo(town, environment);
    EXPECT_EQ(access->signing, "aws:amz:us-east-1:s3");
    EXPECT_FALSE(access->mayRedirect);
    EXPECT_THAT(access->headers, ::testing::Contains("x-amz-security-token: token"));
    const auto plain = accessTo(*RemoteUrl::parse("https://host/town.scan"), environment);
    EXPECT_TRUE(plain->signing.empty() && plain->headers.empty() && plain->user.empty());
    for (RemoteEnvironment half : {RemoteEnvironment{.keyId = "AKID"},
                                   {.secret = "topsecret"},
                                   {.keyId = "A", .secret = "topsecret\r\nX: y"}}) {
        const auto refused = accessTo(town, half);
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, Not(HasSubstr("topsecret")));
    }
}

}  // namespace
}  // namespace scancast
