#include "tests/support/pictures/picture_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scancast {
namespace {

template <class Color>
Frame paint(int width, int height, Color&& color) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int value = color(x, y);
            for (int c = 0; c < 3; ++c) frame.rgba.own().push_back(std::uint8_t(value));
            frame.rgba.own().push_back(255);
        }
    frame.depth.own().assign(std::size_t(width) * std::size_t(height), 1.0F);
    return frame;
}

int pattern(int x, int y) {
    return (x * 37 + y * 91 + x * y * 13) % 256;
}

// A difference of d everywhere has the mean square d²: 20 log10(255 / d) by definition.
TEST(Psnr, IsTheFormulaForEvenDifferences) {
    const Frame grey = paint(40, 30, [](int, int) { return 100; });
    EXPECT_EQ(psnr(grey, grey), std::numeric_limits<double>::infinity());
    for (const int d : {1, 5, 60})
        EXPECT_NEAR(*psnr(grey, paint(40, 30, [&](int, int) { return 100 + d; })), 20 * std::log10(255.0 / d),
                    1e-9);
    // One pixel in four off by 10: the mean square is 25.
    const Frame dotted = paint(40, 30, [](int x, int y) { return x % 2 == 0 && y % 2 == 0 ? 110 : 100; });
    EXPECT_NEAR(*psnr(grey, dotted), 20 * std::log10(255.0 / 5), 1e-9);
}

TEST(Psnr, CountsOnlyWhatTheMaskSays) {
    const Frame grey = paint(10, 10, [](int, int) { return 100; });
    const Frame split = paint(10, 10, [](int x, int) { return x < 5 ? 100 : 120; });
    PixelMask left(100), right(100);
    for (std::size_t i = 0; i < 100; ++i) (i % 10 < 5 ? left : right)[i] = 1;
    EXPECT_EQ(psnr(grey, split, left), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(*psnr(grey, split, right), 20 * std::log10(255.0 / 20), 1e-9);
    EXPECT_FALSE(psnr(grey, split, PixelMask(100)));
    EXPECT_FALSE(psnr(grey, paint(10, 9, pattern)));
    EXPECT_FALSE(psnr(grey, split, PixelMask(99, 1)));
}

TEST(Ssim, IsOneForEqualPictures) {
    const Frame a = paint(32, 24, pattern);
    EXPECT_NEAR(*ssim(a, a), 1, 1e-12);
}

// Two even pictures have no structure, so that only the luminance term remains: (2ab + C1) / (a² + b² + C1).
TEST(Ssim, IsTheLuminanceTermForEvenPictures) {
    const double a = 100, b = 150, c1 = 6.5025;
    const Frame x = paint(20, 20, [](int, int) { return 100; }),
                y = paint(20, 20, [](int, int) { return 150; });
    EXPECT_NEAR(*ssim(x, y), (2 * a * b + c1) / (a * a + b * b + c1), 1e-9);
}

// Written out straight from Eq. 13 of Wang et al.,
// "Image Quality Assessment: From Error Visibility to Structural Similarity", 2004, one window: 121 weights,
// no separable blur.
TEST(Ssim, EqualsTheDefinitionWrittenOut) {
    const Frame x = paint(11, 11, pattern),
                y = paint(11, 11, [](int u, int v) { return (pattern(u, v) + 40 * (u % 3)) % 256; });
    double sum = 0, mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
    const auto weight = [](int u, int v) { return std::exp(-((u - 5) * (u - 5) + (v - 5) * (v - 5)) / 4.5); };
    for (int v = 0; v < 11; ++v)
        for (int u = 0; u < 11; ++u) sum += weight(u, v);
    const auto value = [](const Frame& f, int u, int v) {
        return double(f.rgba[std::size_t(4 * (v * 11 + u))]);
    };
    for (int v = 0; v < 11; ++v)
        for (int u = 0; u < 11; ++u) {
            mx += weight(u, v) / sum * value(x, u, v);
            my += weight(u, v) / sum * value(y, u, v);
        }
    for (int v = 0; v < 11; ++v)
        for (int u = 0; u < 11; ++u) {
            const double w = weight(u, v) / sum, a = value(x, u, v) - mx, b = value(y, u, v) - my;
            xx += w * a * a;
            yy += w * b * b;
            xy += w * a * b;
        }
    const double c1 = 6.5025, c2 = 58.5225;
    EXPECT_NEAR(*ssim(x, y), (2 * mx * my + c1) * (2 * xy + c2) / ((mx * mx + my * my + c1) * (xx + yy + c2)),
                1e-9);
    EXPECT_FALSE(ssim(paint(10, 30, pattern), paint(10, 30, pattern))) << "no window fits";
}

TEST(ChangedPixels, AreThoseBeyondTheThreshold) {
    const Frame before = paint(10, 10, [](int, int) { return 100; });
    const Frame after = paint(10, 10, [](int x, int y) { return y == 0 ? 100 + 4 * x : 100; });
    EXPECT_DOUBLE_EQ(*changedPixels(before, after, 16), 0.05);  // 20 … 36: five of a hundred
    EXPECT_DOUBLE_EQ(*changedPixels(after, before, 0), 0.09);
    EXPECT_DOUBLE_EQ(*changedPixels(before, before, 0), 0);
}

// A square of side s loses a rim of r on all sides: (s - 2r)² is left.
TEST(Holes, AreBackgroundWellInsideTheSilhouette) {
    Frame frame = paint(30, 20, pattern);
    PixelMask mask(600);
    for (int y = 4; y < 16; ++y)
        for (int x = 5; x < 17; ++x) mask[std::size_t(y * 30 + x)] = 1;
    EXPECT_EQ(countHoles(frame, mask, 2)->counted, 64u);
    EXPECT_EQ(countHoles(frame, mask, 2)->pixels, 0u);
    const float nothing = std::numeric_limits<float>::infinity();
    std::vector<float>& depth = frame.depth.own();
    depth[10 * 30 + 10] = depth[6 * 30 + 7] = nothing;  // inside; at the corner of what is counted
    depth[5 * 30 + 10] = depth[0] = nothing;            // in the rim; outside
    EXPECT_EQ(countHoles(frame, mask, 2)->pixels, 2u);
    EXPECT_DOUBLE_EQ(countHoles(frame, mask, 2)->part(), 2.0 / 64);
    EXPECT_EQ(countHoles(frame, mask, 0)->pixels, 3u);
    EXPECT_FALSE(countHoles(frame, PixelMask(5), 1));
}

TEST(Eroded, LeavesTheBorderOfThePictureAlone) {
    EXPECT_EQ(eroded(PixelMask(35, 1), 7, 5, 3), PixelMask(35, 1));
    PixelMask dotted(35, 1);
    dotted[2 * 7 + 3] = 0;
    PixelMask expected(35, 1);
    for (int y = 1; y <= 3; ++y)
        for (int x = 2; x <= 4; ++x) expected[std::size_t(y * 7 + x)] = 0;
    EXPECT_EQ(eroded(dotted, 7, 5, 1), expected);
}

}  // namespace
}  // namespace scancast
