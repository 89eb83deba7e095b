// Which background is part of a surface (docs/spec/pyramid.md §4.4): outlines that are known exactly, of spheres, rings
// and poles, against what is shown.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/point_passes.hpp"

namespace scancast::test {
namespace {

constexpr double pi = 3.14159265358979, eyeDistance = 3;

struct OutlineSetting {
    int width, height;
    bool perspective;
    double spacingPx;
};

std::vector<OutlineSetting> outlineSettings(bool small) {
    std::vector<OutlineSetting> all;
    for (const auto& [width, height] : {std::pair{1248, 768}, {640, 480}}) {
        if (small && width > 640) continue;
        for (const bool perspective : {true, false}) {
            for (const double spacing : {1.5, 2.5, 3.5, 5.0})
                all.push_back({width, height, perspective, spacing});
        }
    }
    return all;
}

std::string nameOf(const OutlineSetting& s) {
    return std::to_string(s.width) + " x " + std::to_string(s.height) + ", every " +
           std::to_string(s.spacingPx) + " px, " + (s.perspective ? "perspective" : "orthographic");
}

PointScreen screenFor(const OutlineSetting& s) {
    return {s.width, s.height, s.perspective, s.perspective ? 1.1 * s.height : 0.4 * s.height};
}

/// Where it is nearest, at depth eyeDistance - thickness.
double spacingOf(const OutlineSetting& s, const PointScreen& screen, double thickness) {
    return s.spacingPx * (s.perspective ? eyeDistance - thickness : 1) / screen.pixelsPerUnit;
}

/// Points of the ring of radius `ring` and `tube` around the view axis, evenly spread with random phases; the unit
/// sphere is the ring of radius 0.
void addRing(PointScreen& screen, double ring, double tube, double spacing) {
    Numbers numbers(15);
    const int turns = static_cast<int>(2 * pi * tube / spacing);
    for (int j = 0; j < turns; ++j) {
        const double v = 2 * pi * (j + numbers.uniform()) / turns, radius = ring + tube * std::cos(v);
        if (radius <= 0) continue;
        const int count = static_cast<int>(2 * pi * radius / spacing) + 1;
        const double phase = numbers.uniform();
        for (int i = 0; i < count; ++i) {
            const double u = 2 * pi * (i + phase) / count;
            screen.add({radius * std::cos(u), radius * std::sin(u), eyeDistance - tube * std::sin(v)}, 0,
                       0xff8040c0);
        }
    }
}

class PyramidOutline : public OnPointPasses {
  protected:
    /// A ring as addRing() makes it, drawn.
    PointScreen ringOf(const OutlineSetting& setting, double ring, double tube) {
        PointScreen s = screenFor(setting);
        const double spacing = spacingOf(setting, s, tube);
        addRing(s, ring, tube, spacing);
        passes_->run(s, spacing);
        return s;
    }
};
SCANCAST_ON_DEVICES(PyramidOutline, "egl");

/// Radius of a ring's outline on the screen, px; side = 1: the outer one, -1: the inner one.
double outlineOf(const PointScreen& s, double ring, double tube, int side) {
    if (!s.perspective) return s.pixelsPerUnit * (ring + side * tube);
    return s.pixelsPerUnit *
           std::tan(std::atan(ring / eyeDistance) + side * std::asin(tube / std::hypot(ring, eyeDistance)));
}

/// Share of the rim, in steps of a pixel, beside which some pixel up to 12 px away is wrong: shown although its middle is
/// more than one pixel outside, or not shown although it is more than one inside.
double wrongRim(const PointScreen& s, double radius, int side) {
    std::vector<bool> wrong(static_cast<std::size_t>(2 * pi * radius));
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            const double right = x + 0.5 - s.width / 2.0, down = y + 0.5 - s.height / 2.0;
            const double outside = side * (std::hypot(right, down) - radius);
            if (std::abs(outside) <= 1 || std::abs(outside) > 12) continue;
            if (std::isinf(s.depth[s.at(x, y)]) == (outside > 0)) continue;
            const double turn = std::atan2(down, right) / (2 * pi) + 0.5;
            wrong[std::min(wrong.size() - 1, static_cast<std::size_t>(turn * double(wrong.size())))] = true;
        }
    }
    return double(std::ranges::count(wrong, true)) / double(wrong.size());
}

TEST_P(PyramidOutline, OfASphereIsKnownToAPixel) {
    for (const OutlineSetting& setting : outlineSettings(slow_)) {
        const PointScreen s = ringOf(setting, 0, 1);
        EXPECT_LE(wrongRim(s, outlineOf(s, 0, 1, 1), 1), 0.01) << nameOf(setting);
    }
}

TEST_P(PyramidOutline, OfATorusIsKnownToAPixel) {
    for (const OutlineSetting& setting : outlineSettings(slow_)) {
        const PointScreen s = ringOf(setting, 0.7, 0.3);
        for (const int side : {1, -1})
            EXPECT_LE(wrongRim(s, outlineOf(s, 0.7, 0.3, side), side), 0.01)
                << nameOf(setting) << ", " << side;
    }
}

/// Two poles under a deck, far apart, before nothing: what is between them stays background. With one level for each
/// block of 16 x 16 px, slabs stood beside them.
TEST_P(PyramidOutline, HasNoSlabsBesidePoles) {
    for (const bool perspective : {true, false}) {
        for (const double spacingPx : {3.0, 4.0, 6.0, 9.0}) {
            PointScreen s(640, 480, perspective, perspective ? 420 : 42);
            const double spacing = spacingPx * (perspective ? 10 : 1) / s.pixelsPerUnit,
                         px = spacing / spacingPx;
            Numbers numbers(3);
            // Upright, and nearer to the eye from left to right: sizes differ.
            const double poles[] = {-120.5, -90.5, -40.5, 30.5, 60.5, 150.5};
            for (const double at : poles) {
                for (double y = -150; y < 100; y += spacingPx / 3)
                    s.add({(at + numbers.uniform(-2, 2)) * px, y * px, 10 - at / 100}, 0);
            }
            for (int i = 0; i < int(400 * 20 / (spacingPx * spacingPx)) * 3; ++i)
                s.add({numbers.uniform(-200, 200) * px, numbers.uniform(100, 120) * px,
                       10 + numbers.uniform(-1, 1)},
                      1);
            const PointScreen before = s;
            passes_->run(s, spacing);
            for (int y = 0; y < s.height; ++y) {
                for (int x = 0; x < s.width; ++x) {
                    if (std::isinf(s.depth[s.at(x, y)])) continue;
                    bool near = false;
                    const int reach = static_cast<int>(2.5 * spacingPx * 1.3) + 1;
                    for (int j = std::max(0, y - reach); j <= std::min(s.height - 1, y + reach); ++j)
                        for (int i = std::max(0, x - reach); i <= std::min(s.width - 1, x + reach); ++i)
                            near |= !std::isinf(before.depth[before.at(i, j)]);
                    ASSERT_TRUE(near) << x << ", " << y << ": " << spacingPx << " px, " << perspective;
                }
            }
        }
    }
}

}  // namespace
}  // namespace scancast::test
