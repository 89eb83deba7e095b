#include "server/net/clients/open_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

namespace scancast {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t plenty = 1 << 20;

TEST(OpenFiles, ConnectionsGoWithSessions) {
    EXPECT_EQ(fittingConnections({64, {}, 0}, plenty), 512U);
    EXPECT_EQ(fittingConnections({100'000, {}, 0}, plenty), 100'448U);
    EXPECT_EQ(fittingConnections({64, 64, 0}, plenty), 64U);
    const auto refused = fittingConnections({64, 63, 0}, plenty);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("--max-sessions 64"));
}

TEST(OpenFiles, WhatDoesNotFitIsSaidAndWhatHelps) {
    const ConnectionWish asked{64, 4000, 10};
    EXPECT_EQ(fittingConnections(asked, asked.files(4000)), 4000U);
    const auto refused = fittingConnections(asked, 1024);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("may have 1024"));
    EXPECT_THAT(refused.error().message, HasSubstr("LimitNOFILE="));
    EXPECT_THAT(refused.error().message, HasSubstr("--max-connections 4000"));
    const std::size_t fit = 1024 - asked.files(0);
    EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(fit) + " connections fit"));
    EXPECT_EQ(fittingConnections({64, fit, 10}, 1024), fit) << "what it says is true";
}

TEST(OpenFiles, WhereNothingWasAskedForFewerWillDo) {
    const ConnectionWish wish{64, {}, 0};
    EXPECT_EQ(fittingConnections(wish, wish.files(100)), 100U);
    EXPECT_FALSE(fittingConnections(wish, wish.files(70))) << "not for sessions and anybody else";
    EXPECT_FALSE(fittingConnections(wish, 10));
}

TEST(OpenFiles, TheSoftLimitIsRaisedAsFarAsItMustAndMay) {
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
    const rlimit low{256, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
    EXPECT_EQ(raiseFileLimit(200), 256U);
    EXPECT_EQ(raiseFileLimit(300), 300U);
    rlimit now{};
    getrlimit(RLIMIT_NOFILE, &now);
    EXPECT_EQ(now.rlim_cur, 300U);
    if (before.rlim_max != RLIM_INFINITY) {
        EXPECT_EQ(raiseFileLimit(before.rlim_max + 1), before.rlim_max);
    }
    setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace scancast
