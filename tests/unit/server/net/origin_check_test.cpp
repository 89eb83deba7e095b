#include "server/net/origin_check.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

OriginRules rules(std::string bind = "127.0.0.1", std::vector<std::string> allowed = {}) {
    return {std::move(bind), std::move(allowed)};
}

TEST(HostCheck, LoopbackNamesAndTheBindAddress) {
    for (const char* host :
         {"127.0.0.1:8080", "localhost", "LOCALHOST:1", "localhost.", "[::1]:8080", "127.8.9.10"}) {
        EXPECT_TRUE(checkHost({host}, rules())) << host;
    }
    EXPECT_TRUE(checkHost({"scans.example.org:80"}, rules("scans.example.org")));
}

// The name of a page that rebinds its own name to 127.0.0.1 still stands in Host.
TEST(HostCheck, OtherNamesAreRefused) {
    for (const char* host : {"evil.example", "evil.example:8080", "localhost.evil.example",
                             "127.0.0.1.evil.example", "192.168.1.7:8080", "[fe80::1]", "127.evil.example"}) {
        const auto checked = checkHost({host}, rules());
        ASSERT_FALSE(checked) << host;
        EXPECT_EQ(checked.error().code, ErrorCode::Unsupported) << host;
    }
}

TEST(HostCheck, MalformedOrMissing) {
    const std::vector<std::vector<std::string>> wrong{{},
                                                      {"localhost", "localhost"},
                                                      {""},
                                                      {"local host"},
                                                      {"localhost:port"},
                                                      {"localhost:123456"},
                                                      {"user@localhost"},
                                                      {"[::1"},
                                                      {"[localhost]"},
                                                      {"localhost:80/"}};
    for (const auto& hosts : wrong) {
        const auto checked = checkHost(hosts, rules());
        ASSERT_FALSE(checked) << ::testing::PrintToString(hosts);
        EXPECT_EQ(checked.error().code, ErrorCode::InvalidArgument) << ::testing::PrintToString(hosts);
    }
}

TEST(HostCheck, ListeningElsewhereAddressesAreFineButNamesMustBeAllowed) {
    EXPECT_TRUE(checkHost({"192.168.1.7:8080"}, rules("0.0.0.0")));
    EXPECT_FALSE(checkHost({"evil.example"}, rules("0.0.0.0")));
    EXPECT_TRUE(checkHost({"viewer.example"}, rules("0.0.0.0", {"https://viewer.example"})));
}

TEST(HostCheck, FurtherNamesOfTheServer) {
    OriginRules known = rules("127.0.0.1");
    known.allowedHosts = {"Scans.Example.org", "192.168.1.7", "fd00::7"};
    for (const char* host : {"scans.example.org", "SCANS.example.org:443", "scans.example.org.",
                             "192.168.1.7:80", "[fd00::7]:8080", "localhost"})
        EXPECT_TRUE(checkHost({host}, known)) << host;
    for (const char* host : {"example.org", "a.scans.example.org", "192.168.1.8", "[fd00::8]"}) {
        const auto refused = checkHost({host}, known);
        ASSERT_FALSE(refused) << host;
        EXPECT_NE(refused.error().message.find("--allowed-host NAME"), std::string::npos)
            << refused.error().message;
    }
    EXPECT_TRUE(checkOrigin({"https://scans.example.org"}, "scans.example.org", known))
        << "a page of that name is the server's own";
    EXPECT_FALSE(checkOrigin({"https://scans.example.org"}, "localhost:8080", known));
}

TEST(HostCheck, FlagValuesOfNames) {
    for (const char* right : {"scans.example.org", "LOCALHOST", "10.0.0.1", "::1", "[::1]"})
        EXPECT_TRUE(checkAllowedHost(right)) << right;
    for (const char* wrong : {"", "*", "*.example.org", "https://a", "a:8080", "[::1]:80", "a/b", "a b"})
        EXPECT_FALSE(checkAllowedHost(wrong)) << wrong;
}

TEST(OriginCheck, SameOriginOnly) {
    EXPECT_TRUE(checkOrigin({}, "localhost:8080", rules()));
    EXPECT_TRUE(checkOrigin({"http://localhost:8080"}, "localhost:8080", rules()));
    EXPECT_TRUE(checkOrigin({"https://localhost"}, "localhost", rules()));
    for (const char* origin :
         {"http://localhost:3000", "http://localhost", "http://127.0.0.1:8080", "null", "",
          "http://evil.example", "file://", "http://localhost:8080.evil.example", "http://localhost:8080/",
          "http://evil@localhost:8080", "ws://localhost:8080"}) {
        EXPECT_FALSE(checkOrigin({origin}, "localhost:8080", rules())) << origin;
    }
    EXPECT_FALSE(checkOrigin({"http://localhost:8080", "http://localhost:8080"}, "localhost:8080", rules()));
}

TEST(OriginCheck, AllowedOnesBySchemeHostAndPort) {
    const auto allowed = rules("127.0.0.1", {"https://viewer.example", "http://localhost:3000"});
    EXPECT_TRUE(checkOrigin({"https://viewer.example"}, "localhost:8080", allowed));
    EXPECT_TRUE(checkOrigin({"https://Viewer.Example:443"}, "localhost:8080", allowed));
    EXPECT_TRUE(checkOrigin({"http://localhost:3000"}, "localhost:8080", allowed));
    EXPECT_FALSE(checkOrigin({"http://viewer.example"}, "localhost:8080", allowed));
    EXPECT_FALSE(checkOrigin({"https://viewer.example:444"}, "localhost:8080", allowed));
    EXPECT_FALSE(checkOrigin({"https://sub.viewer.example"}, "localhost:8080", allowed));
}

TEST(OriginCheck, WhoMayShowThePageInAFrame) {
    EXPECT_EQ(frameAncestors(rules()), "'self'");
    EXPECT_EQ(frameAncestors(rules("127.0.0.1", {"https://Viewer.Example", "http://localhost:3000"})),
              "'self' https://viewer.example http://localhost:3000");
    // Nothing that was let in as an origin is another word of the policy; IPv6 has no spelling there.
    EXPECT_EQ(frameAncestors(rules("127.0.0.1", {"http://[::1]:3000", "http://a; script-src *", "*"})),
              "'self'");
}

TEST(OriginCheck, FlagValues) {
    EXPECT_TRUE(checkAllowedOrigin("https://viewer.example"));
    for (const char* wrong : {"*", "viewer.example", "https://", "https://a/b", "ftp://a"}) {
        EXPECT_FALSE(checkAllowedOrigin(wrong)) << wrong;
    }
}

}  // namespace
}  // namespace scancast
