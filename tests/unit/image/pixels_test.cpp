#include "renderer/image/pixels.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(Pixels, OfItsOwnAreCopied) {
    Pixels<int> a = std::vector{1, 2, 3};
    const Pixels<int> b = a;
    a.own()[1] = 7;
    EXPECT_EQ(a, (Pixels<int>{1, 7, 3}));
    EXPECT_EQ(b, (Pixels<int>{1, 2, 3}));
    EXPECT_NE(a.data(), b.data());
    EXPECT_FALSE(a.lent());
}

TEST(Pixels, LentOnesAreSharedAndGivenBackByTheLast) {
    const std::vector<int> memory{4, 5, 6};
    auto lender = std::make_shared<int>();
    const std::weak_ptr<int> taken = lender;
    auto a = Pixels<int>::lent(memory, std::move(lender));
    Pixels<int> b = a;
    Pixels<int> c = std::move(a);
    EXPECT_TRUE(a.empty() && !a.lent()) << "nothing is left";
    EXPECT_EQ(b.data(), memory.data());
    EXPECT_EQ(c.data(), memory.data());
    EXPECT_EQ(c.size(), 3u);
    b = {};
    EXPECT_FALSE(taken.expired());
    b = c;
    { const Pixels<int> last = std::move(c); }
    EXPECT_FALSE(taken.expired());
    b = Pixels<int>{1};
    EXPECT_TRUE(taken.expired());
}

TEST(Pixels, LentMemoryNeverChanges) {
    const std::vector<int> memory{4, 5, 6};
    auto lender = std::make_shared<int>();
    const std::weak_ptr<int> taken = lender;
    auto pixels = Pixels<int>::lent(memory, std::move(lender));
    pixels.own()[0] = 9;
    EXPECT_EQ(pixels, (Pixels<int>{9, 5, 6}));
    EXPECT_EQ(memory[0], 4);
    EXPECT_TRUE(taken.expired()) << "a copy needs nothing of anybody";
}

}  // namespace
}  // namespace scancast
