// What is measured of pictures, told of frames painted by hand, whose numbers are known.
#include "renderer/look/picture_measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

struct Pixel {
    std::uint8_t grey = 0;
    float depth = INFINITY;
};

Frame painted(int width, int height, const std::function<Pixel(int x, int y)>& paint) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Pixel pixel = paint(x, y);
            frame.depth.own().push_back(pixel.depth);
            for (int c = 0; c < 3; ++c) frame.rgba.own().push_back(pixel.grey);
            frame.rgba.own().push_back(255);
        }
    return frame;
}

TEST(PictureMeasure, OfNothing) {
    const PictureMeasure m = measure(painted(20, 10, [](int, int) { return Pixel{200}; }));
    EXPECT_EQ(m.covered, 0);
    EXPECT_EQ(m.border, 0);
    EXPECT_FALSE(m.isReadable());
}

TEST(PictureMeasure, ABoxIsWhereItIs) {
    // Columns 20 … 59 of 100, rows 10 … 29 of 50.
    const PictureMeasure m = measure(painted(100, 50, [](int x, int y) {
        return x >= 20 && x < 60 && y >= 10 && y < 30 ? Pixel{128, 5} : Pixel{};
    }));
    EXPECT_DOUBLE_EQ(m.covered, 40.0 * 20 / 5000);
    EXPECT_EQ(m.border, 0);
    EXPECT_NEAR(m.fill[0], 0.4, 0.011);
    EXPECT_NEAR(m.fill[1], 0.4, 0.021);
    EXPECT_NEAR(m.middle[0], -0.1, 0.011);
    EXPECT_NEAR(m.middle[1], -0.1, 0.021);
    EXPECT_EQ(m.commonest, 1);
    EXPECT_EQ(m.edges, 0);
    EXPECT_EQ(m.near, 0);
    EXPECT_EQ(m.noise, 0);
    EXPECT_NEAR(m.median, 128 / 255.0, 1e-12);
    EXPECT_EQ(m.spread(), 0);
}

TEST(PictureMeasure, TheWholePictureHasAllOfItsBorder) {
    const PictureMeasure m = measure(painted(31, 17, [](int, int) { return Pixel{10, 1}; }));
    EXPECT_EQ(m.covered, 1);
    EXPECT_EQ(m.border, 1);
    // The left column alone: its pixels among all of the border's.
    const PictureMeasure left = measure(painted(31, 17, [](int x, int) {
        return x == 0 ? Pixel{10, 1} : Pixel{};
    }));
    EXPECT_NEAR(left.border, 17.0 / (2 * 31 + 2 * 17 - 4), 1e-12);
}

TEST(PictureMeasure, LuminanceIsThatOfTheCoveredPixels) {
    // A ramp over 0 … 255 with a white background that does not count.
    const PictureMeasure m = measure(painted(258, 40, [](int x, int) {
        return x >= 1 && x < 257 ? Pixel{std::uint8_t(x - 1), 3} : Pixel{255};
    }));
    EXPECT_NEAR(m.dark, 0.05, 0.005);
    EXPECT_NEAR(m.median, 0.5, 0.005);
    EXPECT_NEAR(m.bright, 0.95, 0.005);
    EXPECT_NEAR(m.commonest, 16.0 / 256, 1e-12) << "16 greys share the upper four bits";
    EXPECT_EQ(m.edges, 0) << "a step of 2/255 is none";
}

TEST(PictureMeasure, EdgesAreStepsBetweenNeighbours) {
    // Halves of black and white: the two columns beside the step see it, the outermost rows and columns are not asked.
    const PictureMeasure halves = measure(painted(40, 30, [](int x, int) {
        return Pixel{std::uint8_t(x < 20 ? 0 : 255), 2};
    }));
    EXPECT_NEAR(halves.edges, 2.0 * 28 / (40 * 30), 1e-12);
    // Stripes two wide: all of them.
    const PictureMeasure stripes = measure(painted(40, 30, [](int x, int) {
        return Pixel{std::uint8_t(x / 2 % 2 ? 255 : 0), 2};
    }));
    EXPECT_NEAR(stripes.edges, 38.0 * 28 / (40 * 30), 1e-12);
    // An outline is no edge: what lies beside it is not the scan.
    const PictureMeasure box = measure(painted(40, 30, [](int x, int) {
        return x < 20 ? Pixel{0, 2} : Pixel{255};
    }));
    EXPECT_EQ(box.edges, 0);
}

TEST(PictureMeasure, NoiseIsWhatNeighboursDoNotShare) {
    const auto noisy = [](int amplitude) {
        return measure(
                   painted(
                       200, 200,
                       [=](int x, int y) {
                           const double dice = test::uniform(std::uint64_t(y * 200 + x));
                           return Pixel{std::uint8_t(128 - amplitude + int(dice * (2 * amplitude + 1))), 2};
                       }))
            .noise;
    };
    EXPECT_EQ(noisy(0), 0);
    EXPECT_GT(noisy(10), 0.005);
    EXPECT_NEAR(noisy(60) / noisy(10), 6, 1.5);
    // A ramp and a clean edge have none.
    EXPECT_LT(measure(painted(200, 200, [](int x, int) { return Pixel{std::uint8_t(x), 2}; })).noise, 0.002);
    EXPECT_EQ(measure(painted(200, 200,
                              [](int x, int) {
                                  return Pixel{std::uint8_t(x < 100 ? 0 : 255), 2};
                              }))
                  .noise,
              0);
}

TEST(PictureMeasure, NearIsMuchNearerThanTheRest) {
    const PictureMeasure m = measure(painted(100, 10, [](int x, int) {
        return Pixel{100, x < 20 ? 1.0f : 10.0f};
    }));
    EXPECT_NEAR(m.near, 0.2, 1e-12);
    EXPECT_EQ(measure(painted(100, 10,
                              [](int x, int) {
                                  return Pixel{100, x < 20 ? 2.0f : 10.0f};
                              }))
                  .near,
              0);
}

TEST(PictureMeasure, ReadableIsOneAndLessIsLess) {
    PictureMeasure good;
    good.dark = 0.2;
    good.median = 0.5;
    good.bright = 0.8;
    good.commonest = 0.1;
    good.edges = 0.1;
    EXPECT_TRUE(good.isReadable());
    EXPECT_EQ(good.readability(), 1);
    const std::vector<std::function<void(PictureMeasure&)>> faults{
        [](auto& m) { m.bright = m.dark + 0.1; }, [](auto& m) { m.median = 0.05; },
        [](auto& m) { m.median = 0.95; }, [](auto& m) { m.commonest = 0.9; },
        [](auto& m) { m.edges = 0.001; }};
    for (std::size_t i = 0; i < faults.size(); ++i) {
        PictureMeasure bad = good;
        faults[i](bad);
        EXPECT_FALSE(bad.isReadable()) << i;
        EXPECT_LT(bad.readability(), 1) << i;
        EXPECT_GT(bad.readability(), 0) << i;
    }
}

}  // namespace
}  // namespace scancast
