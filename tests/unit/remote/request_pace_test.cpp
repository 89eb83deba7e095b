// How much is asked for at once follows what requests take: a line of any rate, played in virtual time, ends up with requests that come to
// their end soon.
#include "remote/request_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace scancast::test {
namespace {

using namespace std::chrono_literals;
constexpr double pieceBits = 8.0 * (64 << 10);

/// A line that all requests share evenly; returns how long the last of many took, in seconds.
double settled(RequestPace& pace, double bitsASecond, double latency) {
    struct UnderWay {
        double begun, left;
    };
    std::vector<UnderWay> requests;
    double now = 0, took = 0;
    const auto at = [](double seconds) {
        return RequestPace::Time(1h) + std::chrono::milliseconds(std::int64_t(seconds * 1000));
    };
    for (int ended = 0; ended < 400;) {
        while (requests.size() < pace.requests())
            requests.push_back({now, double(pace.pieces()) * pieceBits});
        const auto next = std::ranges::min_element(requests, {}, &UnderWay::left);
        const double step = std::max(next->left, 0.0) * double(requests.size()) / bitsASecond;
        now += step;
        for (UnderWay& one : requests) one.left -= step * bitsASecond / double(requests.size());
        took = now - next->begun + latency;
        pace.ended(at(next->begun), at(now + latency), true);
        requests.erase(next);
        ++ended;
    }
    return took;
}

TEST(RequestPaceTest, aQuickLineHasLargeRequestsAndManyOfThem) {
    RequestPace pace({}, 50ms);
    EXPECT_EQ(pace.requests(), 12u);
    EXPECT_EQ(pace.pieces(), 10u) << "to begin with";
    EXPECT_LT(settled(pace, 100e6, 0.05), 3);
    EXPECT_EQ(pace.requests(), 12u);
    EXPECT_EQ(pace.pieces(), 16u);
}

// At 1.7 Mbit/s and less, requests of a megabyte, twelve at a time, took a minute and more.
TEST(RequestPaceTest, onASlowLineEachRequestComesToItsEndSoon) {
    for (const double bits : {1.7e6, 500e3, 250e3, 140e3}) {
        RequestPace pace({}, std::chrono::milliseconds(std::int64_t(300 + 1000 * pieceBits / bits)));
        EXPECT_LE(double(pace.requests()) * double(pace.pieces()) * pieceBits / bits, 8)
            << bits << ", from the first one on";
        EXPECT_LT(settled(pace, bits, 0.3), 10) << bits;
        EXPECT_GE(pace.requests(), 2u);
        EXPECT_GE(pace.pieces(), 1u);
        EXPECT_LT(settled(pace, 200e6, 0.05), 3) << "it has become quick";
        EXPECT_EQ(pace.pieces(), 16u) << bits;
    }
}

TEST(RequestPaceTest, requestsThatAreUnderWayTogetherCountOnce) {
    RequestPace pace({}, 1ms);
    EXPECT_EQ(pace.pieces(), 16u);
    const auto begun = RequestPace::Time(1h);
    for (int i = 0; i < 12; ++i) pace.ended(begun, begun + 30s, false);
    EXPECT_EQ(pace.pieces(), 4u) << "a quarter";
    for (int i = 0; i < 12; ++i) pace.ended(begun + 30s, begun + 31s, true);
    EXPECT_EQ(pace.pieces(), 8u) << "twice";
    for (int i = 2; i < 9; ++i) pace.ended(begun + i * 31s, begun + i * 31s + 30s, true);
    EXPECT_EQ(pace.pieces(), 1u);
    EXPECT_EQ(pace.requests(), 2u) << "never fewer";
}

}  // namespace
}  // namespace scancast::test
