#include "renderer/residency/request_queue.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

std::vector<std::uint32_t> drain(RequestQueue& list) {
    std::vector<std::uint32_t> nodes;
    while (const auto next = list.next()) nodes.push_back(next->node);
    return nodes;
}

TEST(RequestQueue, MostUrgentFirstTiesByNode) {
    RequestQueue list;
    list.set(1, 1, {{5, 1.0}, {6, 3.0}, {9, 2.0}, {7, 2.0}});
    EXPECT_EQ(drain(list), (std::vector<std::uint32_t>{6, 7, 9, 5}));
    EXPECT_TRUE(list.empty());
}

TEST(RequestQueue, NewRequestsTakeThePlaceOfOldOnes) {
    RequestQueue list;
    list.set(1, 1, {{5, 1.0}, {6, 3.0}});
    list.set(1, 1, {{8, 1.0}});
    EXPECT_EQ(list.size(), 1u);
    EXPECT_EQ(drain(list), (std::vector<std::uint32_t>{8}));
    list.set(1, 1, {{5, 1.0}});
    list.set(1, 1, {});
    EXPECT_TRUE(list.empty());
    EXPECT_FALSE(list.next());
}

TEST(RequestQueue, RequestersTakeTurnsWhateverTheirUrgency) {
    RequestQueue list;
    list.set(1, 1, {{10, 900.0}, {11, 800.0}, {12, 700.0}});
    list.set(1, 2, {{20, 2.0}, {21, 1.0}});
    list.set(2, 1, {{30, 0.5}});
    EXPECT_EQ(drain(list), (std::vector<std::uint32_t>{10, 20, 30, 11, 21, 12}));
}

TEST(RequestQueue, WhoAsksAnewKeepsItsTurn) {
    RequestQueue list;
    list.set(1, 1, {{10, 1.0}, {11, 0.5}});
    list.set(1, 2, {{20, 1.0}});
    ASSERT_EQ(list.next()->node, 10u);
    list.set(1, 1, {{12, 9.0}});  // as every frame does: it must not jump the queue
    EXPECT_EQ(drain(list), (std::vector<std::uint32_t>{20, 12}));
}

TEST(RequestQueue, IsBounded) {
    RequestQueue list;
    std::vector<BlockRequest> many;
    for (std::uint32_t i = 0; i < 3 * RequestQueue::mostRequests; ++i) many.push_back({i, double(i)});
    list.set(1, 1, many);
    EXPECT_EQ(list.size(), RequestQueue::mostRequests);
    EXPECT_EQ(list.next()->node, 3 * RequestQueue::mostRequests - 1);
    for (std::uint64_t who = 2; who < 2 * RequestQueue::mostRequesters; ++who) list.set(1, who, {{1, 1.0}});
    EXPECT_LE(list.size(), RequestQueue::mostRequests + RequestQueue::mostRequesters);
}

TEST(RequestQueue, ForgetsACloud) {
    RequestQueue list;
    list.set(1, 1, {{10, 1.0}});
    list.set(2, 1, {{20, 1.0}});
    list.forget(1);
    EXPECT_EQ(drain(list), (std::vector<std::uint32_t>{20}));
}

}  // namespace
}  // namespace scancast
