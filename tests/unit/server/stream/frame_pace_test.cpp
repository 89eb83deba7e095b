#include "server/stream/frame_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Time = FramePace::Time;

TEST(FramePace, TheFirstFrameIsBegunAtOnce) {
    const FramePace pace;
    const Time now{1h};
    EXPECT_TRUE(pace.allows(now, 30, now));
    EXPECT_TRUE(pace.allows(now - 10ms, 30, now));
}

TEST(FramePace, AViewThatComesSomewhatEarlyIsDrawnAtOnceOneThatWaitsLater) {
    FramePace pace;
    const Time begun{1h};
    pace.begin(10, begun);
    const auto came = [&](std::chrono::milliseconds after) {
        return pace.allows(begun + after, 10, begun + after);
    };
    EXPECT_FALSE(came(59ms));
    EXPECT_TRUE(came(60ms));
    EXPECT_FALSE(pace.allows(begun + 30ms, 10, begun + 100ms)) << "there may be a younger one soon";
    EXPECT_EQ(pace.due(10), begun + 110ms);
    EXPECT_TRUE(pace.allows(begun + 30ms, 10, begun + 110ms));
}

/// A client that sends its next view when the frame of the one before is there.
TEST(FramePace, WhoWaitsForEachFrameGetsAsManyAsWanted) {
    FramePace pace;
    const Time start{1h};
    Time now = start;
    pace.begin(30, now);
    for (int frame = 0; frame < 300; ++frame) {
        const Time view = now + 12ms;
        now = pace.allows(view, 30, view) ? view : std::max(view, pace.due(30));
        ASSERT_TRUE(pace.allows(view, 30, now));
        pace.begin(30, now);
    }
    EXPECT_NEAR(std::chrono::duration<double>(now - start).count(), 10, 0.1);
}

TEST(FramePace, APauseIsNotMadeUpFor) {
    FramePace pace;
    const Time begun{1h}, later = begun + 10s;
    pace.begin(30, begun);
    pace.begin(30, later);
    EXPECT_FALSE(pace.allows(later + 10ms, 30, later + 10ms));
}

}  // namespace
}  // namespace scancast
