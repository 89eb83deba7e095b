#include "server/access/failed_logins.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace scancast {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FailedLoginsTest : public ::testing::Test {
  protected:
    std::optional<seconds> fail(const std::string& client, int at, LoginFailure why = LoginFailure::Unknown) {
        return logins.failed(client, why, FailedLogins::Time(seconds(at)));
    }

    std::vector<std::string> lines;
    FailedLoginLimits limits{10, seconds(6), 16, seconds(60), 5};
    FailedLogins logins{[this](const std::string& line) { lines.push_back(line); }, limits};
};

TEST_F(FailedLoginsTest, TenAtOnceAndThenOneInSixSeconds) {
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(fail("192.0.2.1", 0)) << i;
    EXPECT_EQ(fail("192.0.2.1", 0), seconds(6));
    EXPECT_EQ(fail("192.0.2.1", 4), seconds(2));
    EXPECT_FALSE(fail("192.0.2.2", 4)) << "another address is another one's";
    EXPECT_FALSE(fail("192.0.2.1", 6));
    EXPECT_EQ(fail("192.0.2.1", 7), seconds(5));
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(fail("192.0.2.1", 1000)) << i;
    EXPECT_TRUE(fail("192.0.2.1", 1000)) << "no more than at the start, however long it was quiet";
}

TEST_F(FailedLoginsTest, ALineAMinuteCountsWhatCameBetween) {
    fail("192.0.2.1", 0, LoginFailure::Malformed);
    for (int i = 0; i < 500; ++i) fail("192.0.2.1", 1 + i / 10);
    ASSERT_THAT(lines, ElementsAre("failed login from 192.0.2.1: what was sent is no token"));
    fail("192.0.2.1", 60);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(
        lines[1],
        "501 failed logins from 192.0.2.1 since the last line about it; of the last one, the token is not "
        "one of this server's");
}

TEST_F(FailedLoginsTest, WhatWaitsIsToldWhenAnybodyFails) {
    for (int i = 0; i < 3; ++i) fail("192.0.2.1", 0);
    fail("192.0.2.2", 61);
    EXPECT_THAT(lines, ElementsAre(HasSubstr("failed login from 192.0.2.1"),
                                   HasSubstr("2 failed logins from 192.0.2.1"),
                                   HasSubstr("failed login from 192.0.2.2")));
}

TEST_F(FailedLoginsTest, ManyAddressesTakeBoundedMemoryAndLines) {
    for (int i = 0; i < 1000; ++i) fail("client " + std::to_string(i), 0);
    EXPECT_EQ(logins.size(), limits.addresses);
    EXPECT_EQ(lines.size(), 5U);
    fail("client 999", 61);
    ASSERT_GT(lines.size(), 5U);
    // Five were told; the others are not lost, whether their addresses are still known or not.
    EXPECT_THAT(lines[5],
                HasSubstr("failed logins: 979 more, from addresses that were too many to tell each"));
    EXPECT_LE(lines.size(), 10U);
}

}  // namespace
}  // namespace scancast
