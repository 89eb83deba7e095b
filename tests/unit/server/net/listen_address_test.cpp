#include "server/net/listen_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(ListenAddress, HostAndPort) {
    for (const char* text :
         {"127.0.0.1:9090", "[::1]:9090", "localhost:0", "probes.example.org:65535", "0.0.0.0:1"}) {
        const auto address = parseListenAddress(text, "admin-listen");
        ASSERT_TRUE(address) << text;
        EXPECT_EQ(address->text(), text);
    }
    EXPECT_EQ(parseListenAddress("[::1]:9090", "x")->host, "::1");
}

TEST(ListenAddress, WhatIsNoneIsSaidWithTheFlag) {
    for (const char* wrong :
         {"", "9090", ":9090", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "::1",
          "::1:9090", "[::1]", "[::1]9090", "[::1:9090", "[localhost]:1", "a b:1", "http://a:1",
          "[127.0.0.1]:1", "127.0.0.1:0x1", "127.0.0.1:1 "}) {
        const auto refused = parseListenAddress(wrong, "admin-listen");
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::StartsWith("--admin-listen ")) << wrong;
        EXPECT_EQ(refused.error().field, "admin-listen");
    }
    EXPECT_THAT(parseListenAddress("::1:9090", "x").error().message, testing::HasSubstr("brackets"));
}

}  // namespace
}  // namespace scancast
