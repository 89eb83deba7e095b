#include "client/cpp/server_url.hpp"

#include <gtest/gtest.h>

namespace scancast::client {
namespace {

TEST(ServerUrl, WhatPeopleType) {
    EXPECT_EQ(*parseServerUrl("http://127.0.0.1:8080/"), (ServerUrl{"127.0.0.1", 8080}));
    EXPECT_EQ(*parseServerUrl("http://127.0.0.1:8080"), (ServerUrl{"127.0.0.1", 8080}));
    EXPECT_EQ(*parseServerUrl("ws://scans.example.org"), (ServerUrl{"scans.example.org", 80}));
    EXPECT_EQ(*parseServerUrl("http://[::1]:65535/"), (ServerUrl{"::1", 65535}));
    EXPECT_EQ(parseServerUrl("http://[::1]")->authority(), "[::1]:80");
    EXPECT_EQ(parseServerUrl("http://a-b_c.d")->authority(), "a-b_c.d:80");
}

TEST(ServerUrl, WhatIsNoneSaysHowToWriteOne) {
    for (const auto* text : {"",
                             "127.0.0.1:8080",
                             "localhost",
                             "http://",
                             "http:///",
                             "http://:80",
                             "http://a:",
                             "http://a:0",
                             "http://a:65536",
                             "http://a:-1",
                             "http://a:8o80",
                             "http://a:80:80",
                             "http://[::1",
                             "http://[]:80",
                             "http://[::1]x",
                             "http://[zz]",
                             "http://a b",
                             "http://a\r\nX:1",
                             "http://u@h",
                             "http://a/path",
                             "http://a/?q",
                             "http://a?q",
                             "ftp://a",
                             "://a"}) {
        const auto url = parseServerUrl(text);
        ASSERT_FALSE(url) << text;
        EXPECT_EQ(url.error().code, ErrorCode::InvalidArgument) << text;
        EXPECT_NE(url.error().message.find("http://127.0.0.1:8080/"), std::string::npos)
            << url.error().message;
    }
    EXPECT_FALSE(parseServerUrl("http://" + std::string(10'000, 'a')));
}

TEST(ServerUrl, TlsIsAnotherSchemeAndPort) {
    EXPECT_EQ(parseServerUrl("https://a").value(), (ServerUrl{"a", 443, true}));
    EXPECT_EQ(parseServerUrl("wss://a:1/").value(), (ServerUrl{"a", 1, true}));
    EXPECT_FALSE(parseServerUrl("ws://a").value().tls);
}

}  // namespace
}  // namespace scancast::client
