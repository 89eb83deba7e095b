#include "server/net/log/repeats.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;

const RepeatLimits limits{60s, 5, 600, 6000, 1024, 20};
const Repeats::Time start{std::chrono::hours(1)};

TEST(Repeats, FailuresThatSayTheSameAreToldAFewTimesAndThenCounted) {
    Repeats repeats(limits);
    int written = 0;
    for (int i = 0; i < 10'000; ++i) written += repeats.admit("a", 404, "refused", start + 1ms * i) ? 1 : 0;
    EXPECT_EQ(written, 5);
    EXPECT_TRUE(repeats.admit("b", 404, "refused", start)) << "another client";
    EXPECT_TRUE(repeats.admit("a", 429, "refused", start)) << "another status";
    EXPECT_TRUE(repeats.admit("a", 404, "/x", start)) << "another route";
    EXPECT_TRUE(repeats.admit("a", 200, "/x", start)) << "what is served";
    EXPECT_TRUE(repeats.passTime(start + 59s).empty());
    EXPECT_EQ(repeats.passTime(start + 60s), (std::vector<Repeated>{{{"a", 404, "refused"}, 9995}}));
    EXPECT_TRUE(repeats.passTime(start + 500s).empty());
    EXPECT_TRUE(repeats.admit("a", 404, "refused", start + 60s));
}

TEST(Repeats, WhatIsServedHasALimitToo) {
    Repeats repeats(limits);
    int written = 0;
    for (int i = 0; i < 10'000; ++i) written += repeats.admit("a", 200, i % 2 ? "/x" : "/y", start) ? 1 : 0;
    EXPECT_EQ(written, 600);
    EXPECT_EQ(repeats.finish(), (std::vector<Repeated>{{{"a", 0, ""}, 9400}}));
}

// A flood from everywhere: what is remembered, what is written and what is told of it stay small.
TEST(Repeats, ManyClientsGainNothingByBeingMany) {
    Repeats repeats(limits);
    int written = 0;
    for (int client = 0; client < 50'000; ++client)
        for (int i = 0; i < 3; ++i)
            written += repeats.admit(std::to_string(client), 400 + i % 2, "refused", start) ? 1 : 0;
    EXPECT_LE(written, 6000);
    EXPECT_LE(repeats.remembered(), 1025u);
    const auto told = repeats.passTime(start + 60s);
    EXPECT_LE(told.size(), 21u);
    std::uint64_t times = 0;
    for (const Repeated& one : told) times += one.times;
    EXPECT_EQ(times + std::uint64_t(written), 150'000u) << "none is forgotten";
    EXPECT_EQ(repeats.remembered(), 0u);
}

TEST(Repeats, WithoutLimitsNothingIsLeftOut) {
    Repeats repeats(std::nullopt);
    for (int i = 0; i < 10'000; ++i) ASSERT_TRUE(repeats.admit("a", 404, "refused", start));
    EXPECT_EQ(repeats.remembered(), 0u);
    EXPECT_TRUE(repeats.passTime(start + 100s).empty());
}

}  // namespace
}  // namespace scancast
