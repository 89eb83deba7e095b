#include "server/net/clients/trusted_proxies.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancast {
namespace {

using Headers = std::vector<std::pair<std::string, std::string>>;

constexpr const char* proxyAddress = "10.0.0.1";

CountedClient counted(Headers headers, const char* peer = proxyAddress) {
    const std::vector<std::string> ranges{"10.0.0.0/8", "2001:db8:ffff::/48"};
    return TrustedProxies::parse(ranges).value().clientOf({"GET", "/", std::move(headers)},
                                                          IpAddress::parse(peer).value());
}
CountedClient standard(std::string value) {
    return counted({{"forwarded", std::move(value)}});
}
CountedClient usual(std::string value) {
    return counted({{"x-forwarded-for", std::move(value)}});
}

const CountedClient someone{"203.0.113.9", true};
const CountedClient theProxy{proxyAddress, false};
const CountedClient unclear{proxyAddress, true};

TEST(TrustedProxies, NobodyElseIsBelieved) {
    for (const char* peer : {"198.51.100.1", "11.0.0.1", "127.0.0.1"}) {
        const CountedClient found =
            counted({{"x-forwarded-for", "203.0.113.9"}, {"forwarded", "for=203.0.113.9"}}, peer);
        EXPECT_EQ(found, (CountedClient{peer, true}));
    }
    EXPECT_EQ(counted({{"x-forwarded-for", "203.0.113.9"}}, "2001:db8::7"),
              (CountedClient{"2001:db8::/64", true}));
}

TEST(TrustedProxies, ItsOwnRequestsAreItsOwn) {
    EXPECT_EQ(counted({}), theProxy);
}

TEST(TrustedProxies, TheRightmostThatIsNoProxyIsTheClient) {
    for (const char* value :
         {"203.0.113.9", "6.6.6.6, 203.0.113.9", "6.6.6.6,203.0.113.9 , 10.2.3.4", "6.6.6.6\t,\t203.0.113.9",
          "garbage \" ; , 203.0.113.9", "203.0.113.9:5000", "unknown, 203.0.113.9, 10.0.0.9, 10.0.0.8"})
        EXPECT_EQ(usual(value), someone) << value;
    for (const char* value :
         {"for=203.0.113.9", "For=\"203.0.113.9\"", "for=\"203.0.113.9:47011\"", "for=203.0.113.9:47011",
          "for=6.6.6.6, for=203.0.113.9", "for=203.0.113.9;proto=https;by=10.0.0.1",
          "proto=https;for=203.0.113.9 , for=10.2.3.4", "for=\"_x\", for=203.0.113.9;host=\"a, for=6.6.6.6\"",
          "for=\"203.0.113.\\9\"", "for=\"203.0.113.9:_port\""})
        EXPECT_EQ(standard(value), someone) << value;
}

TEST(TrustedProxies, LinesGoOnFromEachOther) {
    EXPECT_EQ(counted({{"x-forwarded-for", "6.6.6.6, 203.0.113.9"}, {"x-forwarded-for", "10.0.0.7"}}),
              someone);
    EXPECT_EQ(counted({{"forwarded", "for=\"unterminated"}, {"forwarded", "for=203.0.113.9"}}), someone)
        << "what a client wrote into a line of his own does not touch the proxy's";
}

TEST(TrustedProxies, Version6) {
    const CountedClient network{"2001:db8:cafe::/64", true};
    for (const char* value : {"for=\"[2001:db8:cafe::17]\"", "for=\"[2001:db8:cafe::17]:4711\"",
                              "For=\"[2001:db8:cafe::17]\", for=\"[2001:db8:ffff::1]\""})
        EXPECT_EQ(standard(value), network) << value;
    for (const char* value : {"2001:db8:cafe::17", "[2001:db8:cafe::17]", "[2001:db8:cafe::17]:80"})
        EXPECT_EQ(usual(value), network) << value;
    EXPECT_EQ(usual("::ffff:203.0.113.9"), someone);
}

TEST(TrustedProxies, OfProxiesAloneTheFirstIsTheClient) {
    EXPECT_EQ(usual("10.0.0.3, 10.0.0.2"), (CountedClient{"10.0.0.3", true}));
}

TEST(TrustedProxies, WhoIsHiddenByHisProxyIsCountedForIt) {
    for (const char* value : {"for=unknown", "for=_SEVKISEK", "for=\"_hidden\";proto=http",
                              "for=203.0.113.9, for=Unknown", "proto=https", "for=\"unknown:80\""})
        EXPECT_EQ(standard(value), theProxy) << value;
    EXPECT_EQ(usual("203.0.113.9, unknown"), theProxy);
}

TEST(TrustedProxies, WhatIsMalformedIsNobodys) {
    for (const char* value : {"",
                              ",",
                              "for",
                              "for=",
                              "for=\"",
                              "for=\"203.0.113.9",
                              "for=203.0.113.9,",
                              "for=203.0.113.9;for=6.6.6.6",
                              "for=[2001:db8::1]",
                              "for=\"[2001:db8::1\"",
                              "for=\"2001:db8::1]\"",
                              "for=203.0.113.9 for=6.6.6.6",
                              "for=203.0.113.9;x=\", for=6.6.6.6",
                              "for=\"203.0.113.9\\",
                              "=203.0.113.9",
                              "for=host.example",
                              "for=\"203.0.113.9:port\"",
                              "for=\"[203.0.113.9]\"",
                              "for=203.0.113.9:123456",
                              "for=_"})
        EXPECT_EQ(standard(value), unclear) << value;
    for (const char* value : {"", " ", ",", "203.0.113.9,", "host.example", "203.0.113.9:", "[::1",
                              "203.0.113.9 6.6.6.6", "1.2.3"})
        EXPECT_EQ(usual(value), unclear) << value;
    EXPECT_EQ(usual(std::string(16000, ',')), unclear);
    EXPECT_EQ(standard(std::string(16000, '"')), unclear);
}

TEST(TrustedProxies, TwoHeadersThatDisagreeAreNobodys) {
    EXPECT_EQ(counted({{"forwarded", "for=203.0.113.9"}, {"x-forwarded-for", "203.0.113.9"}}), someone);
    EXPECT_EQ(counted({{"forwarded", "for=6.6.6.6"}, {"x-forwarded-for", "203.0.113.9"}}), unclear)
        << "a proxy that writes one of them passes a client's other one on";
    EXPECT_EQ(counted({{"forwarded", "for=unknown"}, {"x-forwarded-for", "203.0.113.9"}}), unclear);
}

TEST(TrustedProxies, AFlagThatIsNoRangeIsNamed) {
    const std::vector<std::string> ranges{"10.0.0.0/8", "proxy.example"};
    const auto refused = TrustedProxies::parse(ranges);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::StartsWith("--trusted-proxy: \"proxy.example\""));
}

}  // namespace
}  // namespace scancast
