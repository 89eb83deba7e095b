#include "server/stream/quality.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(Quality, FullEffortIsTheViewItselfWithOneSample) {
    View wanted;
    wanted.width = 801;
    wanted.height = 603;
    wanted.quality.samples = 16;
    const View moving = movingView(wanted, movingQuality(1, 1.3, {}));
    View expected = wanted;
    expected.quality.samples = 1;
    expected.quality.detail = 1.3;
    EXPECT_EQ(moving, expected);
}

TEST(Quality, NeverBelowTheLimits) {
    const MovingLimits limits;
    for (double detail : {0.0, 0.5, 1.0, 2.0, 7.0}) {
        for (double effort : {1e-9, 0.01, 0.1, 0.3, 0.9}) {
            const MovingQuality quality = movingQuality(effort, detail, limits);
            EXPECT_LE(quality.detail, std::max(limits.maxDetail, detail)) << detail << " " << effort;
            EXPECT_GE(quality.detail, detail);
            EXPECT_GE(quality.resolution, limits.minResolution);
            EXPECT_LE(quality.resolution, 1);
        }
    }
}

TEST(Quality, DetailPaysBeforeResolution) {
    const MovingQuality quality = movingQuality(0.5, 1, {});
    EXPECT_GT(quality.detail, 1);
    EXPECT_EQ(quality.resolution, 1);
    const MovingQuality poor = movingQuality(0.1, 1, {});
    EXPECT_EQ(poor.detail, 2);
    EXPECT_LT(poor.resolution, 1);
}

TEST(Quality, TheSizeDoesNotTrembleWithTheMeasurements) {
    double before = movingQuality(0.16, 1, {}).resolution;
    const double first = before;
    for (int i = 0; i < 20; ++i) {
        before = movingQuality(i % 2 ? 0.15 : 0.165, 1, {}, before).resolution;
        EXPECT_EQ(before, first);
    }
    EXPECT_GT(movingQuality(0.24, 1, {}, before).resolution, first);
}

TEST(Quality, LeastEffortIsEverythingAtItsLimit) {
    const MovingLimits limits;
    const MovingQuality quality = movingQuality(leastEffort(1, limits), 1, limits);
    EXPECT_EQ(quality.detail, limits.maxDetail);
    EXPECT_EQ(quality.resolution, limits.minResolution);
    EXPECT_EQ(movingQuality(leastEffort(1, limits), 1, limits, 0.625).resolution, limits.minResolution)
        << "whatever the size was before";
}

// Oracle: a renderer that behaves as the model says must end at the wanted time, or at the limits when that
// is not enough, whatever its speed.
TEST(Quality, SettlesAtTheWantedRateOfAModelRenderer) {
    const MovingLimits limits;
    for (double fullMs : {5.0, 40.0, 80.0, 200.0, 2000.0}) {
        double effort = 1;
        double frameMs = 0;
        for (int frame = 0; frame < 60; ++frame) {
            const MovingQuality quality = movingQuality(effort, 1, limits);
            frameMs = fullMs * costOf(quality, 1);
            effort = nextEffort(quality, frameMs, 1, limits);
        }
        const double floorMs = fullMs * leastEffort(1, limits);
        const double wantedMs = 1000 / limits.fps;
        if (fullMs <= 0.9 * wantedMs) {
            EXPECT_EQ(effort, 1) << fullMs;
        } else if (floorMs >= wantedMs) {
            EXPECT_DOUBLE_EQ(frameMs, floorMs);
        } else {
            // Resolution moves in steps of an eighth, so the time may be off by the square of one.
            EXPECT_LT(frameMs, wantedMs * 1.35) << fullMs;
            EXPECT_GT(frameMs, wantedMs * 0.5) << fullMs;
        }
    }
}

TEST(Quality, FallsAtOnceAndRisesSlowly) {
    EXPECT_LT(nextEffort(movingQuality(1, 1, {}), 120, 1, {}), 0.3);
    EXPECT_DOUBLE_EQ(nextEffort(movingQuality(0.4, 1, {}), 0.001, 1, {}), 0.5);
}

TEST(Quality, TinyPicturesStayPictures) {
    View wanted;
    wanted.width = wanted.height = 1;
    const View moving = movingView(wanted, movingQuality(1e-6, 1, {}));
    EXPECT_EQ(moving.width, 1);
    EXPECT_EQ(moving.height, 1);
}

}  // namespace
}  // namespace scancast
