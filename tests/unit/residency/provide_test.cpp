#include "renderer/residency/provide.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/unit/residency/toy_cloud.hpp"

namespace scancast {
namespace {

class Provide : public test::ToyCloud {};

// Right because it walks up from every leaf, as the selection's oracle does: what the wanted cut showed once
// is shown once, by the wanted node or by its nearest ancestor that has samples, or, without any such, not at
// all.
TEST_F(Provide, EveryLeafOnceWhateverIsInMemory) {
    for (std::uint64_t i = 0; i < 600; ++i) {
        makeResident(i, std::array{0.02, 0.3, 0.6, 0.95}[i % 4]);
        if (i % 2) store_->resident.insert(0);
        const Cut wanted = randomCut(i);
        const auto given = provide(octree_, wanted, {.wait = false});
        ASSERT_TRUE(given);
        std::set<std::uint32_t> asked, drawn;
        for (const CutRun& run : wanted.runs) asked.insert(run.nodeIndex);
        std::uint32_t ordinal = 0, before = 0;
        for (const CutRun& run : given->runs) {
            ASSERT_TRUE(store_->resident.contains(run.nodeIndex));
            ASSERT_TRUE(drawn.insert(run.nodeIndex).second);
            ASSERT_TRUE(&run == given->runs.data() || run.nodeIndex > before);
            before = run.nodeIndex;
            ASSERT_EQ(run.node, &octree_.node(run.nodeIndex));
            ASSERT_EQ(run.samples.size(), run.node->sampleCount);
            ASSERT_EQ(run.samples[0].x, run.nodeIndex);
            ASSERT_EQ(run.firstOrdinal, ordinal);
            ordinal += run.node->sampleCount;
        }
        ASSERT_EQ(given->samples, ordinal);
        std::uint32_t missing = 0;
        for (const CutRun& run : wanted.runs) missing += !store_->resident.contains(run.nodeIndex);
        EXPECT_EQ(given->nodesMissing, missing);
        EXPECT_EQ(given->samplesMissing, missing * 4u);
        for (std::uint32_t leaf = 0; leaf < octree_.nodes().size(); ++leaf) {
            if (!octree_.node(leaf).isLeaf()) continue;
            std::uint32_t want = noNode, nearest = noNode;
            int times = 0;
            for (std::uint32_t up = leaf; up != noNode; up = octree_.node(up).parent) {
                if (asked.contains(up)) want = up;
                times += drawn.contains(up);
                if (want != noNode && nearest == noNode && store_->resident.contains(up)) nearest = up;
            }
            if (want == noNode) {
                ASSERT_LE(times, 1);  // culled: an ancestor that stands in for a neighbour may show it
            } else {
                ASSERT_EQ(times, nearest == noNode ? 0 : 1) << "case " << i << ", leaf " << leaf;
            }
        }
    }
}

// Right because it walks up from every leaf: what the wanted cut covered by a whole run, the given one covers
// by a whole run that is not finer, wherever any ancestor is in memory; parts of runs are never what a leaf
// depends on.
TEST_F(Provide, NoHolesWhereLevelsFade) {
    std::uint64_t partial = 0, missing = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
        makeResident(i, std::array{0.3, 0.6, 0.9, 0.97}[i % 4]);
        store_->resident.insert(0);
        const Cut wanted = fadingCut(i);
        const auto given = provide(octree_, wanted, {.wait = false});
        ASSERT_TRUE(given);
        missing += given->nodesMissing;
        std::map<std::uint32_t, const CutRun*> drawn;
        for (const CutRun& run : given->runs) {
            drawn[run.nodeIndex] = &run;
            partial += run.share < 1;
            ASSERT_TRUE(store_->resident.contains(run.nodeIndex));
        }
        for (std::uint32_t leaf = 0; leaf < octree_.nodes().size(); ++leaf) {
            if (!octree_.node(leaf).isLeaf()) continue;
            int whole = 0;
            for (std::uint32_t up = leaf; up != noNode; up = octree_.node(up).parent)
                whole += drawn.contains(up) && drawn[up]->share == 1;
            ASSERT_EQ(whole, 1) << "case " << i << ", leaf " << leaf;
        }
    }
    EXPECT_GT(partial, 300u);
    EXPECT_GT(missing, 300u);
}

TEST_F(Provide, RequestsAreWhatIsMissingCoarserFirst) {
    for (std::uint64_t i = 0; i < 100; ++i) {
        makeResident(i, 0.4);
        const Cut wanted = randomCut(i);
        ASSERT_TRUE(provide(octree_, wanted, {.wait = false, .requester = 42}));
        EXPECT_EQ(store_->requester, 42u);
        std::set<std::uint32_t> due;
        for (const CutRun& run : wanted.runs)
            for (std::uint32_t up = run.nodeIndex; up != noNode && !store_->resident.contains(up);
                 up = octree_.node(up).parent)
                due.insert(up);
        std::set<std::uint32_t> asked;
        for (const BlockRequest& request : store_->requests) {
            const std::uint32_t up = octree_.node(request.node).parent;
            if (up != noNode && due.contains(up)) {
                ASSERT_TRUE(asked.contains(up)) << "a node before its parent";
            }
            ASSERT_TRUE(asked.insert(request.node).second);
        }
        EXPECT_EQ(asked, due);
    }
}

TEST_F(Provide, NothingMissingTakesBackEarlierRequests) {
    makeResident(1, 0.5);
    ASSERT_TRUE(provide(octree_, randomCut(1), {.wait = false}));
    ASSERT_FALSE(store_->requests.empty());
    makeResident(1, 1.1);
    ASSERT_TRUE(provide(octree_, randomCut(1), {.wait = false}));
    EXPECT_TRUE(store_->requests.empty());
}

// A picture and what its mirrors show: one request names the nodes of both, and only one is made.
TEST_F(Provide, OneCutRequestsForAllOfAPicture) {
    makeResident(5, 0.4);
    const Cut picture = randomCut(5), mirror = randomCut(6);
    const auto asked = [&] {
        std::set<std::uint32_t> nodes;
        for (const BlockRequest& request : store_->requests) nodes.insert(request.node);
        return nodes;
    };
    std::set<std::uint32_t> both;
    for (const Cut* cut : {&picture, &mirror}) {
        ASSERT_TRUE(provide(octree_, *cut, {.wait = false}));
        both.merge(asked());
    }
    ASSERT_TRUE(provide(octree_, picture, {.wait = false, .beside = mirror.runs}));
    EXPECT_EQ(asked(), both);
    for (const BlockRequest& request : store_->requests) EXPECT_GT(request.urgency, 0);
    ASSERT_TRUE(provide(octree_, mirror, {.wait = false, .request = false}));
    EXPECT_EQ(asked(), both);
}

TEST_F(Provide, WhatIsAheadComesBehindWhatIsMissing) {
    makeResident(5, 0.5);
    const Cut wanted = randomCut(5);
    Cut ahead;
    for (std::uint32_t n = 0; n < octree_.nodes().size(); ++n) {
        if (!octree_.node(n).isLeaf()) continue;
        CutRun run;
        run.node = &octree_.node(n);
        run.nodeIndex = n;
        run.projected = 1000;
        ahead.runs.push_back(run);
    }
    ASSERT_TRUE(provide(octree_, wanted, {.wait = false}));
    const auto now = store_->requests;
    ASSERT_TRUE(provide(octree_, wanted, {.wait = false, .ahead = ahead.runs}));
    ASSERT_GT(store_->requests.size(), now.size());
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_EQ(store_->requests[i].node, now[i].node);
    EXPECT_LT(store_->requests[now.size()].urgency, 0);
}

TEST_F(Provide, WaitingGivesExactlyWhatIsWanted) {
    for (std::uint64_t i = 0; i < 50; ++i) {
        makeResident(i, 0.5);
        const Cut wanted = randomCut(i);
        const auto given = provide(octree_, wanted);
        ASSERT_TRUE(given);
        ASSERT_EQ(given->runs.size(), wanted.runs.size());
        for (std::size_t r = 0; r < wanted.runs.size(); ++r) {
            EXPECT_EQ(given->runs[r].nodeIndex, wanted.runs[r].nodeIndex);
            EXPECT_EQ(given->runs[r].firstOrdinal, wanted.runs[r].firstOrdinal);
            EXPECT_EQ(given->runs[r].samples[0].x, wanted.runs[r].nodeIndex);
        }
        EXPECT_EQ(given->keep.size(), wanted.runs.size());
        EXPECT_EQ(given->nodesMissing, 0u);
        EXPECT_EQ(given->spacingReached, wanted.spacingReached);
    }
}

TEST_F(Provide, ADamagedBlockIsReplacedByItsParent) {
    for (const bool wait : {true, false}) {
        makeResident(9, wait ? 0.5 : 1.1);
        const Cut wanted = randomCut(9);
        const std::uint32_t broken = wanted.runs.back().nodeIndex, parent = octree_.node(broken).parent;
        ASSERT_NE(parent, noNode);
        store_->broken = {broken};
        store_->resident.erase(broken);
        const auto given = provide(octree_, wanted, {.wait = wait});
        ASSERT_TRUE(given);
        EXPECT_EQ(given->damaged.size(), 1u);
        EXPECT_EQ(given->nodesMissing, 0u);
        std::set<std::uint32_t> drawn;
        for (const CutRun& run : given->runs) drawn.insert(run.nodeIndex);
        EXPECT_TRUE(drawn.contains(parent));
        for (const CutRun& run : wanted.runs)
            EXPECT_EQ(drawn.contains(run.nodeIndex), octree_.node(run.nodeIndex).parent != parent);
    }
}

// Else the picture would be drawn as if nothing more were to come, and be another one a moment later.
TEST_F(Provide, WhatStandsInForADamagedBlockIsMissingUntilItIsHere) {
    makeResident(9, 1.1);
    const Cut wanted = randomCut(9);
    const std::uint32_t broken = wanted.runs.back().nodeIndex, parent = octree_.node(broken).parent;
    store_->broken = {broken};
    store_->resident.erase(broken);
    store_->resident.erase(parent);
    const auto early = provide(octree_, wanted, {.wait = false});
    ASSERT_TRUE(early);
    EXPECT_EQ(early->damaged, std::vector<std::uint32_t>{broken});
    EXPECT_EQ(early->samplesMissing, octree_.node(parent).sampleCount);
    EXPECT_TRUE(std::ranges::any_of(store_->requests, [&](const auto& r) { return r.node == parent; }));
    store_->resident.insert(parent);
    const auto now = provide(octree_, wanted, {.wait = false}), waited = provide(octree_, wanted);
    ASSERT_TRUE(now && waited);
    EXPECT_EQ(now->samplesMissing, 0u);
    EXPECT_EQ(now->damaged, waited->damaged);
    ASSERT_EQ(now->runs.size(), waited->runs.size());
    for (std::size_t r = 0; r < now->runs.size(); ++r)
        EXPECT_EQ(now->runs[r].nodeIndex, waited->runs[r].nodeIndex);
}

TEST_F(Provide, APictureThatLacksSomethingSaysWhetherWhatItComesFromIsAway) {
    makeResident(9, 1.1);
    const Cut wanted = randomCut(9);
    store_->away = true;
    const auto whole = provide(octree_, wanted, {.wait = false});
    ASSERT_TRUE(whole);
    EXPECT_FALSE(whole->away) << "all that is wanted is here";
    store_->resident.erase(wanted.runs.back().nodeIndex);
    for (const bool away : {true, false}) {
        store_->away = away;
        const auto coarser = provide(octree_, wanted, {.wait = false});
        ASSERT_TRUE(coarser);
        EXPECT_GT(coarser->samplesMissing, 0u);
        EXPECT_EQ(coarser->away, away);
    }
}

TEST_F(Provide, ADamagedRootIsNotTheEnd) {
    store_->broken = {0};
    Cut wanted;
    CutRun run;
    run.node = &octree_.node(0);
    run.nodeIndex = 0;
    wanted.runs.push_back(run);
    const auto given = provide(octree_, wanted);
    ASSERT_TRUE(given);
    EXPECT_TRUE(given->runs.empty());
    EXPECT_EQ(given->damaged.size(), 1u);
}

TEST_F(Provide, ACancelledWaitIsAnError) {
    std::stop_source stop;
    stop.request_stop();
    const auto given = provide(octree_, randomCut(1), {}, stop.get_token());
    ASSERT_FALSE(given);
    EXPECT_EQ(given.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace scancast
