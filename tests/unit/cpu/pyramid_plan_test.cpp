// How far a block of pixels looks, by comparing depths with a table, against its definition by logarithms
// (docs/spec/pyramid.md §4.1): the same at every depth, the borders between two levels included.
#include "renderer/device/host/screens.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {
namespace {

int reachByDefinition(const PyramidView& view, const HiddenPointsPass& pass, float depth, int widest) {
    const double scaled = pass.scale * double(pass.spacing) * view.pixelsPerUnit;
    const double px = std::max(view.perspective ? scaled / depth : scaled, pass.scale * 2.0 * pass.detail);
    return px >= 1 ? std::clamp(std::ilogb(px), 0, widest) : 0;
}

TEST(HiddenPointsNumbers, ReachIsItsDefinition) {
    Numbers numbers(4);
    int changes = 0;
    for (int i = 0; i < 400; ++i) {
        PyramidView view;
        view.perspective = i % 4 != 0;
        view.pixelsPerUnit = std::exp(numbers.uniform(-3, 9));
        HiddenPointsPass pass;
        pass.spacing = static_cast<float>(std::exp(numbers.uniform(-9, 3)));
        pass.detail = i % 3 == 0 ? 0 : static_cast<float>(numbers.uniform(0, 3));
        const HiddenPointsNumbers n = hiddenPointsNumbers(view, pass);
        const auto compare = [&](float depth) {
            if (!(depth > 0)) return;
            for (const int widest : {0, 3, 9})
                ASSERT_EQ(n.reachAt(depth, widest), reachByDefinition(view, pass, depth, widest)) << depth;
        };
        for (int k = 0; k < 30; ++k) compare(static_cast<float>(std::exp(numbers.uniform(-8, 9))));
        for (const float border : n.farthest) {
            if (!(border > 0) || std::isinf(border)) continue;
            compare(border);
            compare(std::nextafter(border, 0.0f));
            compare(std::nextafter(border, 1e30f));
            changes += n.reachAt(border, 9) != n.reachAt(std::nextafter(border, 1e30f), 9) ? 1 : 0;
        }
    }
    EXPECT_GT(changes, 500);
}

TEST(PyramidShape, HalvesUpToOneTexel) {
    const PyramidShape s = pyramidShape(1248, 768);
    EXPECT_EQ(s.levels, 12);
    EXPECT_EQ(s.width[11], 1);
    EXPECT_EQ(s.height[10], 1);
    EXPECT_EQ(s.widest, 7);         // 10 x 6
    EXPECT_EQ(s.normalLevels, 10);  // 3 x 2
    // A single pixel still has the level that neighbourhoods are chosen by.
    const PyramidShape one = pyramidShape(1, 1);
    EXPECT_EQ(one.levels, blockLevel + 1);
    EXPECT_EQ(one.widest, 0);
    EXPECT_EQ(one.normalLevels, 1);
}

}  // namespace
}  // namespace scancast::test
