#include "renderer/image/tone_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scancast {
namespace {

double lightOf(double value) {
    const double s = value / 255;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

TEST(ToneCurve, NoStopsChangeNothing) {
    const auto curve = toneCurve(0);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(curve[i], i);
}

TEST(ToneCurve, KeepsTheOrderAndBlackAndWhite) {
    for (const double stops : {-3.0, -1.0, 0.1, 1.0, 3.0}) {
        const auto curve = toneCurve(stops);
        EXPECT_EQ(curve[0], 0) << stops;
        EXPECT_EQ(curve[255] == 255, stops > 0) << stops;
        for (std::size_t i = 1; i < 256; ++i) EXPECT_GE(curve[i], curve[i - 1]) << stops << ' ' << i;
    }
}

TEST(ToneCurve, AStopIsTwiceTheLightBelowTheShoulder) {
    for (const double stops : {-2.0, -1.0, 1.0, 2.0}) {
        const auto curve = toneCurve(stops);
        for (std::size_t i = 0; i < 256; ++i) {
            const double wanted = lightOf(double(i)) * std::exp2(stops);
            if (stops > 0 && wanted > 0.5) break;
            EXPECT_GE(wanted, lightOf(curve[i] - 0.501)) << stops << ' ' << i;
            EXPECT_LE(wanted, lightOf(curve[i] + 0.501)) << stops << ' ' << i;
        }
    }
}

// Nothing clips: what is told apart by more than the curve's flattest part stays apart up to white.
TEST(ToneCurve, TheBrightestStayApart) {
    const auto curve = toneCurve(1);
    for (std::size_t i = 192; i + 4 < 256; i += 4) EXPECT_GT(curve[i + 4], curve[i]) << i;
}

TEST(ToneCurve, SmallStopsAreSmallSteps) {
    const auto less = toneCurve(-0.01), more = toneCurve(0.01);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_LE(more[i] - less[i], 2) << i;
}

}  // namespace
}  // namespace scancast
