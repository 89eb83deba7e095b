#include "server/net/clients/ip_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancast {
namespace {

IpAddress address(std::string_view text) {
    return IpAddress::parse(text).value();
}

bool within(std::string_view range, std::string_view text) {
    return AddressRange::parse(range).value().contains(address(text));
}

TEST(IpAddress, IsReadAndWritten) {
    EXPECT_EQ(address("192.168.1.7").text(), "192.168.1.7");
    EXPECT_EQ(address("2001:DB8:0:0::1").text(), "2001:db8::1");
    EXPECT_EQ(address("::ffff:10.0.0.1"), address("10.0.0.1")) << "one client, however it comes";
    using namespace std::string_literals;
    for (const std::string& wrong :
         {""s, "10.0.0"s, "10.0.0.256"s, "010.0.0.1"s, "1.2.3.4:80"s, "[::1]"s, ":::"s, "fe80::1%eth0"s,
          " 1.2.3.4"s, "1.2.3.4\0"s, std::string(500, '1')})
        EXPECT_FALSE(IpAddress::parse(wrong)) << wrong;
}

TEST(IpAddress, AClientIsAnAddressOrANetworkOfVersion6) {
    EXPECT_EQ(address("192.168.1.7").client(), "192.168.1.7");
    EXPECT_EQ(address("2001:db8:1:2:3:4:5:6").client(), "2001:db8:1:2::/64");
    EXPECT_EQ(address("2001:db8:1:2::9").client(), address("2001:db8:1:2:ffff::1").client());
    EXPECT_NE(address("2001:db8:1:2::9").client(), address("2001:db8:1:3::9").client());
}

TEST(IpAddress, Loopback) {
    for (const char* own : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"})
        EXPECT_TRUE(address(own).isLoopback()) << own;
    for (const char* other : {"128.0.0.1", "10.0.0.1", "::2", "::"})
        EXPECT_FALSE(address(other).isLoopback()) << other;
}

TEST(AddressRange, ContainsWhatBeginsWithTheSameBits) {
    EXPECT_TRUE(within("10.0.0.0/8", "10.255.1.2"));
    EXPECT_FALSE(within("10.0.0.0/8", "11.0.0.0"));
    EXPECT_TRUE(within("192.168.1.128/25", "192.168.1.200"));
    EXPECT_FALSE(within("192.168.1.128/25", "192.168.1.127"));
    EXPECT_TRUE(within("192.168.1.7", "192.168.1.7"));
    EXPECT_FALSE(within("192.168.1.7", "192.168.1.6"));
    EXPECT_TRUE(within("fc00::/7", "fd12::1"));
    EXPECT_FALSE(within("2001:db8::/33", "2001:db8:8000::1"));
    EXPECT_TRUE(within("2001:db8::1", "2001:db8::1"));
    EXPECT_TRUE(within("::ffff:10.0.0.0/104", "10.1.2.3"));
}

TEST(AddressRange, OfEverythingIsOfOneVersion) {
    EXPECT_TRUE(within("0.0.0.0/0", "203.0.113.9"));
    EXPECT_FALSE(within("0.0.0.0/0", "2001:db8::1"));
    EXPECT_TRUE(within("::/0", "2001:db8::1"));
    EXPECT_FALSE(within("::/0", "203.0.113.9"));
}

TEST(AddressRange, WhatIsNoneIsSaid) {
    for (const char* wrong : {"", "proxy.example", "10.0.0.0/", "10.0.0.0/33", "10.0.0.0/-1", "10.0.0.0/8 ",
                              "/8", "::/129", "10.0.0.0/8/8", "::ffff:10.0.0.0/8"}) {
        const auto refused = AddressRange::parse(wrong);
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::HasSubstr("no range of addresses")) << wrong;
    }
    const auto doubtful = AddressRange::parse("10.1.0.0/8");
    ASSERT_FALSE(doubtful);
    EXPECT_THAT(doubtful.error().message, testing::HasSubstr("10.0.0.0/8"));
    EXPECT_THAT(doubtful.error().message, testing::HasSubstr("10.1.0.0 alone"));
}

}  // namespace
}  // namespace scancast
