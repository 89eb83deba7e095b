#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "simulator/permutation.hpp"

namespace scancast {
namespace {

// A shuffle hits every number exactly once, by definition.
TEST(Permutation, IsABijection) {
    for (const std::uint64_t count : {1u, 2u, 3u, 7u, 16u, 17u, 1000u, 4096u, 100003u}) {
        const Permutation shuffle(count, 5);
        std::vector<bool> hit(count);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::uint64_t to = shuffle(i);
            ASSERT_LT(to, count);
            ASSERT_FALSE(hit[to]) << i << " of " << count;
            hit[to] = true;
        }
    }
}

// In a uniform shuffle the mean distance of an element from its old place is N / 3.
TEST(Permutation, MovesFarAndDependsOnTheSeed) {
    constexpr std::int64_t count = 30000;
    const Permutation one(count, 1), two(count, 2);
    double moved = 0;
    int same = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        moved += double(std::llabs(std::int64_t(one(std::uint64_t(i))) - i));
        same += one(std::uint64_t(i)) == two(std::uint64_t(i));
    }
    EXPECT_NEAR(moved / count, count / 3.0, count / 60.0);
    EXPECT_LT(same, 20);
}

}  // namespace
}  // namespace scancast
