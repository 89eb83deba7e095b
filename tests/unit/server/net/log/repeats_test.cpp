#include "server/net/log/repeats.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;

const RepeatLimits usualLimits{60s, 5, 600, 6000, 1024, 20};
const Repeats::Time windowBegin{std::chrono::hours(1)};

TEST(Repeats, FailuresThatSayTheSameAreToldAFewTimesAndThenCounted) {
    Repeats repeats(usualLimits);
    int written = 0;
    for (int i = 0; i < 10'000; ++i)
        written += repeats.admit("a", 404, "refused", windowBegin + 1ms * i) ? 1 : 0;
    EXPECT_EQ(written, 5);
    EXPECT_TRUE(repeats.admit("b", 404, "refused", windowBegin)) << "another client";
    EXPECT_TRUE(repeats.admit("a", 429, "refused", windowBegin)) << "another status";
    EXPECT_TRUE(repeats.admit("a", 404, "/x", windowBegin)) << "another route";
    EXPECT_TRUE(repeats.admit("a", 200, "/x", windowBegin)) << "what is served";
    EXPECT_TRUE(repeats.passTime(windowBegin + 59s).empty());
    EXPECT_EQ(repeats.passTime(windowBegin + 60s), (std::vector<Repeated>{{{"a", 404, "refused"}, 9995}}));
    EXPECT_TRUE(repeats.passTime(windowBegin + 500s).empty());
    EXPECT_TRUE(repeats.admit("a", 404, "refused", windowBegin + 60s));
}

TEST(Repeats, WhatIsServedHasALimitToo) {
    Repeats repeats(usualLimits);
    int written = 0;
    for (int i = 0; i < 10'000; ++i)
        written += repeats.admit("a", 200, i % 2 ? "/x" : "/y", windowBegin) ? 1 : 0;
    EXPECT_EQ(written, 600);
    EXPECT_EQ(repeats.finish(), (std::vector<Repeated>{{{"a", 0, ""}, 9400}}));
}

// A flood from everywhere: what is remembered, what is written and what is told of it stay small.
TEST(Repeats, ManyClientsGainNothingByBeingMany) {
    Repeats repeats(usualLimits);
    int written = 0;
    for (int client = 0; client < 50'000; ++client)
        for (int i = 0; i < 3; ++i)
            written += repeats.admit(std::to_string(client), 400 + i % 2, "refused", windowBegin) ? 1 : 0;
    EXPECT_LE(written, 6000);
    EXPECT_LE(repeats.remembered(), 1025u);
    const auto told = repeats.passTime(windowBegin + 60s);
    EXPECT_LE(told.size(), 21u);
    std::uint64_t times = 0;
    for (const Repeated& one : told) times += one.times;
    EXPECT_EQ(times + std::uint64_t(written), 150'000u) << "none is forgotten";
    EXPECT_EQ(repeats.remembered(), 0u);
}

TEST(Repeats, WithoutLimitsNothingIsLeftOut) {
    Repeats repeats(std::nullopt);
    for (int i = 0; i < 10'000; ++i) ASSERT_TRUE(repeats.admit("a", 404, "refused", windowBegin));
    EXPECT_EQ(repeats.remembered(), 0u);
    EXPECT_TRUE(repeats.passTime(windowBegin + 100s).empty());
}

}  // namespace
}  // namespace scancast
