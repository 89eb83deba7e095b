#include "renderer/cloud/build/morton.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "renderer/cloud/build/nodes/leaf.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

GridPosition scattered(std::uint64_t i) {
    const auto axis = [&](std::uint64_t stream) {
        // Many bit lengths, so that differences on every level occur.
        const int bits = 1 + int(test::uniform(i, stream + 3) * 41);
        return std::uint64_t(test::uniform(i, stream) * double(std::uint64_t(1) << bits));
    };
    return {axis(1), axis(2), axis(3)};
}

std::string interleaved(const GridPosition& p) {
    std::string key;
    for (int bit = gridBits - 1; bit >= 0; --bit)
        for (int a = 2; a >= 0; --a) key.push_back(p[a] >> bit & 1 ? '1' : '0');
    return key;
}

TEST(Morton, OrderIsThatOfInterleavedBits) {
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        const GridPosition a = scattered(i), b = scattered(i + 1);
        ASSERT_EQ(mortonLess(a, b), interleaved(a) < interleaved(b));
        ASSERT_FALSE(mortonLess(a, a));
    }
}

TEST(Morton, KeysAreInTheSameOrder) {
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        GridPosition a = scattered(i), b = scattered(i + 1);
        for (int axis = 0; axis < 3; ++axis) a[axis] &= 0xffff, b[axis] &= 0xffff;
        ASSERT_EQ(mortonKey(a[0], a[1], a[2]) < mortonKey(b[0], b[1], b[2]), mortonLess(a, b));
    }
}

TEST(Morton, CellCountEqualsCountingCells) {
    std::vector<GridPosition> positions;
    for (std::uint64_t i = 0; i < 5000; ++i) positions.push_back(scattered(i));
    std::sort(positions.begin(), positions.end(), mortonLess);
    CellCount count;
    count.addFirst();
    for (std::size_t i = 1; i < positions.size(); ++i) count.addStep(positions[i - 1], positions[i]);
    for (int cellLevel = 0; cellLevel <= gridBits; ++cellLevel) {
        std::set<GridPosition> cells;
        for (const GridPosition& p : positions)
            cells.insert({p[0] >> cellLevel, p[1] >> cellLevel, p[2] >> cellLevel});
        EXPECT_EQ(count.cells(cellLevel), cells.size()) << cellLevel;
    }
}

TEST(Morton, LeavesAreInItsOrderWhateverTheyWere) {
    // Few and many, within one block of keys and across blocks, with points at the same place.
    for (const std::uint64_t count : {3u, 1000u, 1500u, 40'000u})
        for (const std::uint64_t corner : {std::uint64_t(0), (std::uint64_t(1) << 20) - 9000}) {
            std::vector<BuildPoint> points(count);
            GridBox box;
            for (std::uint64_t i = 0; i < count; ++i) {
                GridPosition at;
                for (std::size_t a = 0; a < 3; ++a)
                    at[a] = corner + std::uint64_t(test::uniform(i, a + 1) * (i % 7 == 0 ? 40 : 30'000));
                points[i].setPosition(at);
                points[i].intensity = std::uint16_t(test::uniform(i, 4) * 3);
                box.add(at);
            }
            std::vector<BuildPoint> expected = points;
            std::sort(expected.begin(), expected.end(), [](const BuildPoint& a, const BuildPoint& b) {
                if (a.position() != b.position()) return mortonLess(a.position(), b.position());
                return a.intensity < b.intensity;
            });
            makeLeaf(points, box, Grid{}, glm::dvec3(0));
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(points[i].position(), expected[i].position()) << count << ", " << i;
                ASSERT_EQ(points[i].intensity, expected[i].intensity) << count << ", " << i;
            }
        }
}

}  // namespace
}  // namespace scancast
