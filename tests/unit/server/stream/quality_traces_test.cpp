// The quality controller on networks as they are, in simulated time. What is asserted holds with room to
// spare: it tells a controller that works from one that does not, not one tuning from another.
#include <gtest/gtest.h>

#include <set>

#include "tests/support/serving/simulated_link.hpp"

namespace scancast::test {
namespace {

constexpr double mbit = 1e6 / 8;

struct Summary {
    double framesPerSecond = 0, latency = 0, jpegQuality = 0, resolution = 0;
    int leastJpegQuality = 100;
    double leastResolution = 1;
    int sizeChanges = 0;
};

/// Of the frames that were acknowledged between the two times.
Summary between(const std::vector<SimulatedFrame>& frames, double from, double to) {
    Summary sum;
    double count = 0, before = 0;
    for (const SimulatedFrame& frame : frames) {
        if (frame.acknowledged < from || frame.acknowledged >= to) continue;
        ++count;
        sum.latency += frame.acknowledged - frame.ordered;
        sum.jpegQuality += frame.quality.jpegQuality;
        sum.resolution += frame.quality.resolution;
        sum.leastJpegQuality = std::min(sum.leastJpegQuality, frame.quality.jpegQuality);
        sum.leastResolution = std::min(sum.leastResolution, frame.quality.resolution);
        if (before > 0 && before != frame.quality.resolution) ++sum.sizeChanges;
        before = frame.quality.resolution;
    }
    sum.framesPerSecond = count / (to - from);
    if (count == 0) return sum;
    for (double* mean : {&sum.latency, &sum.jpegQuality, &sum.resolution}) *mean /= count;
    return sum;
}

bool isFull(const MovingQuality& quality) {
    return quality.resolution == 1 && quality.jpegQuality == 90 && quality.detail == 1;
}

TEST(QualityTraces, ALocalNetworkIsNeverALimit) {
    SimulatedStream stream({always(1000 * mbit), always(0.0005)});
    for (const auto& frame : stream.run(5)) ASSERT_TRUE(isFull(frame.quality)) << "at " << frame.ordered;
}

TEST(QualityTraces, NoFirstFrameIsBlurredByAGuess) {
    for (double bandwidth : {0.5, 2.0, 20.0, 1000.0}) {
        for (double roundTrip : {0.001, 0.1, 0.6}) {
            SimulatedStream stream({always(bandwidth * mbit), always(roundTrip)});
            const auto frames = stream.run(20);
            ASSERT_GE(frames.size(), 2U);
            EXPECT_TRUE(isFull(frames[0].quality) && isFull(frames[1].quality))
                << bandwidth << " " << roundTrip;
        }
    }
}

TEST(QualityTraces, FiveGFollowsADipAndIsBackWithinASecond) {
    SimulatedStream stream({[](double t) { return (t > 2 && t < 5 ? 5 : 100) * mbit; }, always(0.03)});
    const auto frames = stream.run(8);
    EXPECT_EQ(between(frames, 0, 2).leastResolution, 1);
    const Summary dip = between(frames, 3, 5);
    EXPECT_GE(dip.framesPerSecond, 20);
    EXPECT_LE(dip.latency, 0.15);
    const Summary after = between(frames, 6, 8);
    EXPECT_EQ(after.leastResolution, 1);
    EXPECT_EQ(after.leastJpegQuality, 90);
}

TEST(QualityTraces, AHotelsHiccupsAreLivedWith) {
    // 4 Mbit/s that stop for 150 ms now and then.
    const auto bandwidth = [](double t) {
        const double phase = std::fmod(t, 1.3);
        return phase > 1 && phase < 1.15 ? 0 : 4 * mbit;
    };
    SimulatedStream stream({bandwidth, always(0.04)});
    const Summary steady = between(stream.run(15), 3, 15);
    EXPECT_GE(steady.framesPerSecond, 15);
    EXPECT_GE(steady.jpegQuality, 50);
    EXPECT_LE(steady.sizeChanges, 6);
}

TEST(QualityTraces, ASatelliteIsFarNotSlow) {
    SimulatedStream stream({always(20 * mbit), always(0.6)});
    const auto frames = stream.run(20);
    const Summary all = between(frames, 0, 20);
    EXPECT_EQ(all.leastResolution, 1);
    EXPECT_GE(all.leastJpegQuality, 70);
    EXPECT_GE(all.framesPerSecond, 2.4) << "two frames in a round trip are all that the window allows";
}

TEST(QualityTraces, AfterTenSecondsOfNothingItIsAsGoodAsBefore) {
    SimulatedStream stream({[](double t) { return t > 3 && t < 13 ? 0 : 30 * mbit; }, always(0.03)});
    const auto frames = stream.run(16);
    const Summary before = between(frames, 1, 3), after = between(frames, 14, 16);
    EXPECT_GE(after.jpegQuality, before.jpegQuality - 3);
    EXPECT_GE(after.resolution, before.resolution - 0.01);
    EXPECT_GE(after.framesPerSecond, 0.9 * before.framesPerSecond);
}

TEST(QualityTraces, ASteadyLinkGetsASteadyPicture) {
    SimulatedStream stream({always(5 * mbit), always(0.05)});
    const Summary steady = between(stream.run(20), 2, 20);
    EXPECT_GE(steady.framesPerSecond, 16);
    EXPECT_LE(steady.latency, 0.16);
    EXPECT_LE(steady.sizeChanges, 9) << "in eighteen seconds";
}

TEST(QualityTraces, TwoMegabitsAndATenthOfASecondStillMove) {
    SimulatedStream stream({always(2 * mbit), always(0.1)});
    stream.view.width = 640;
    stream.view.height = 360;
    const Summary steady = between(stream.run(12), 2, 12);
    EXPECT_GE(steady.framesPerSecond, 10);
    EXPECT_LE(steady.latency, 0.3);
}

TEST(QualityTraces, ALongerWayIsNotTakenForASlowerOneForEver) {
    SimulatedStream stream({always(40 * mbit), [](double t) { return t < 2 ? 0.03 : 0.2; }});
    const auto frames = stream.run(16);
    EXPECT_EQ(between(frames, 0, 2).leastResolution, 1);
    EXPECT_EQ(between(frames, 12, 16).leastResolution, 1);
}

TEST(QualityTraces, TheFloorsHoldHoweverSlowTheNetwork) {
    SimulatedStream stream({[](double t) { return (t < 1 ? 8 : 0.3) * mbit; }, always(0.05)});
    stream.fullRenderMs = 400;
    for (const auto& frame : stream.run(20)) {
        ASSERT_GE(frame.quality.resolution, 0.5);
        ASSERT_GE(frame.quality.jpegQuality, 40);
        ASSERT_LE(frame.quality.detail, 2);
    }
    EXPECT_EQ(between(stream.run(21), 15, 21).leastJpegQuality, 40) << "and are used";
    SimulatedStream lower({always(0.3 * mbit), always(0.05)});
    lower.limits.minJpegQuality = 10;
    lower.limits.minResolution = 0.25;
    const Summary allowed = between(lower.run(40), 30, 40);
    EXPECT_LT(allowed.leastJpegQuality, 40);
    EXPECT_EQ(allowed.leastResolution, 0.25);
}

TEST(QualityTraces, ChromaPaysFirst) {
    SimulatedStream stream({always(20 * mbit), always(0.02)});
    stream.view.quality.subsampling = Subsampling::S444;
    const auto frames = stream.run(4);
    EXPECT_EQ(frames.front().quality.subsampling, Subsampling::S444);
    EXPECT_EQ(frames.back().quality.subsampling, Subsampling::S420);
    EXPECT_EQ(frames.back().quality.resolution, 1);
}

TEST(QualityTraces, ASlowRendererIsFollowedWithoutANetworkToBlame) {
    SimulatedStream stream({always(1000 * mbit), always(0.001)});
    stream.fullRenderMs = 80;
    const auto frames = stream.run(4);
    const Summary steady = between(frames, 2, 4);
    EXPECT_GE(steady.framesPerSecond, 28);
    EXPECT_EQ(steady.leastJpegQuality, 90);
    EXPECT_LE(steady.sizeChanges, 2);
}

TEST(QualityController, AViewThatAsksForLessThanTheFloorGetsIt) {
    SimulatedStream stream({always(0.5 * mbit), always(0.02)});
    stream.view.quality.jpegQuality = 25;
    for (const auto& frame : stream.run(8)) ASSERT_EQ(frame.quality.jpegQuality, 25);
}

// Eight sessions share one device: what one of them measures is its own frame, what counts is the round.
TEST(QualityController, FramesOfOthersCountAgainstTheRate) {
    QualityController alone, crowded;
    const View view;
    const MovingLimits limits;
    for (int i = 0; i < 50; ++i) {
        alone.drawn(alone.choose(view, 1, limits), {15, 1, 0}, 1, limits);
        crowded.drawn(crowded.choose(view, 1, limits), {15, 1, 7}, 1, limits);
    }
    EXPECT_TRUE(isFull(alone.choose(view, 1, limits)));
    EXPECT_EQ(crowded.choose(view, 1, limits).detail, 2);
}

TEST(LinkEstimate, SaysNothingBeforeSomethingIsProved) {
    LinkEstimate link;
    LinkEstimate::Time now{std::chrono::hours(1)};
    EXPECT_FALSE(link.bandwidth());
    link.acknowledged(1, 0.03, now);  // never sent: ignored
    link.sent(1, 100'000, now);
    link.acknowledged(1, 0.03, now + std::chrono::milliseconds(500));
    EXPECT_FALSE(link.bandwidth()) << "half a second may be all latency";
    EXPECT_DOUBLE_EQ(link.latency(), 0.5);
}

TEST(LinkEstimate, TwoFramesBackToBackTellTheBandwidth) {
    LinkEstimate link;
    const LinkEstimate::Time now{std::chrono::hours(1)};
    const auto at = [&](int ms) { return now + std::chrono::milliseconds(ms); };
    link.sent(1, 50'000, now);
    link.sent(2, 50'000, at(1));
    link.acknowledged(1, 0.03, at(200));
    link.acknowledged(2, 0.03, at(300));  // 100 ms behind the one before: 500 kB/s
    ASSERT_TRUE(link.bandwidth());
    EXPECT_NEAR(*link.bandwidth(), 500'000, 10'000);
}

// With two frames always on their way, waiting looks like latency; now and then one has to go alone.
TEST(LinkEstimate, WantsQuietWhenNoFrameHasBeenAloneForLong) {
    LinkEstimate link;
    const LinkEstimate::Time now{std::chrono::hours(1)};
    const auto at = [&](int ms) { return now + std::chrono::milliseconds(ms); };
    link.sent(1, 50'000, now);
    EXPECT_FALSE(link.wantsQuiet(now)) << "it is alone";
    link.acknowledged(1, 0.03, at(100));
    link.sent(2, 50'000, at(100));
    link.sent(3, 50'000, at(101));
    EXPECT_FALSE(link.wantsQuiet(at(200)));
    EXPECT_TRUE(link.wantsQuiet(at(5000)));
    link.acknowledged(3, 0.03, at(5000));
    EXPECT_FALSE(link.wantsQuiet(at(5000))) << "nothing is on its way";
}

TEST(LinkEstimate, OneAcknowledgementMayStandForSeveralFrames) {
    LinkEstimate link;
    const LinkEstimate::Time now{std::chrono::hours(1)};
    const auto at = [&](int ms) { return now + std::chrono::milliseconds(ms); };
    link.sent(1, 10'000, now);
    link.acknowledged(1, 0.03, at(20));
    link.sent(2, 50'000, at(20));
    link.sent(3, 50'000, at(21));
    link.acknowledged(3, 0.03, at(240));
    ASSERT_TRUE(link.bandwidth());
    EXPECT_NEAR(*link.bandwidth(), 500'000, 50'000);
}

}  // namespace
}  // namespace scancast::test
