#include "renderer/residency/on_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "renderer/residency/provide.hpp"
#include "tests/unit/residency/toy_cloud.hpp"

namespace scancast {
namespace {

/// Keeps what DeviceMemory promises with a list, and counts.
class ToyMemory final : public DeviceMemory {
  public:
    ToyMemory(std::uint64_t capacity, std::uint64_t budget) : capacity_(capacity), budget_(budget) {}

    std::uint64_t capacity() const override { return capacity_; }
    std::uint64_t frameBudget() const override { return budget_; }
    std::uint64_t bytes() const override { return used() * sizeof(Sample); }
    bool has(std::uint64_t source, std::uint32_t node, std::uint32_t, bool) const override {
        return source == source_ && position(node) != nodes_.end();
    }
    Expected<void> bring(std::uint64_t source, std::span<const CutRun> runs,
                         const std::stop_token&) override {
        source_ = source;
        for (auto run = runs.rbegin(); run != runs.rend(); ++run) touch(run->nodeIndex);
        std::set<std::uint32_t> needed;
        for (const CutRun& run : runs) {
            EXPECT_EQ(run.samples.size(), run.node->sampleCount) << "what is brought has samples";
            const bool isHere = position(run.nodeIndex) != nodes_.end();
            const std::uint64_t wanted = isHere ? 0 : run.samples.size();
            while (used() + wanted > capacity_ && !needed.contains(nodes_.back().node)) nodes_.pop_back();
            if (used() + wanted > capacity_) break;
            if (!isHere) nodes_.insert(nodes_.begin(), {run.nodeIndex, run.samples.size()});
            touch(run.nodeIndex);
            needed.insert(run.nodeIndex);
            moved += wanted;
        }
        return {};
    }
    /// Drawing uploads what it lacks.
    void draw(std::uint64_t source, const Cut& cut) { ASSERT_TRUE(bring(source, cut.runs, {})); }
    std::uint64_t used() const {
        std::uint64_t samples = 0;
        for (const Held& held : nodes_) samples += held.samples;
        return samples;
    }
    std::set<std::uint32_t> held() const {
        std::set<std::uint32_t> nodes;
        for (const Held& one : nodes_) nodes.insert(one.node);
        return nodes;
    }

    std::uint64_t moved = 0;

  private:
    struct Held {
        std::uint32_t node;
        std::uint64_t samples;
    };
    std::vector<Held>::const_iterator position(std::uint32_t node) const {
        return std::ranges::find(nodes_, node, &Held::node);
    }
    void touch(std::uint32_t node) {
        const auto at = position(node);
        if (at == nodes_.end()) return;
        const Held held = *at;
        nodes_.erase(at);
        nodes_.insert(nodes_.begin(), held);
    }

    const std::uint64_t capacity_, budget_;
    std::uint64_t source_ = 0;
    std::vector<Held> nodes_;  // most recently used first
};

class OnDevice : public test::ToyCloud {
  protected:
    /// As provide() hands it on.
    Cut filled(const Cut& wanted) {
        auto cut = provide(octree_, wanted, {.wait = true});
        EXPECT_TRUE(cut);
        return std::move(*cut);
    }
    Cut onDevice(const Cut& wanted, ToyMemory& memory) {
        Cut cut = filled(wanted);
        Cut* const cuts[] = {&cut};
        EXPECT_TRUE(provideOnDevice(octree_, cuts, memory, {}));
        memory.draw(octree_.source(), cut);
        return cut;
    }
    void everythingIsInMemory() { makeResident(0, 1.1); }
    std::uint64_t samplesOf(const Cut& cut) const {
        std::uint64_t samples = 0;
        for (const CutRun& run : cut.runs) samples += run.node->sampleCount;
        return samples;
    }
    /// With all ancestors, each once.
    std::uint64_t samplesUpTo(const Cut& cut) const {
        std::set<std::uint32_t> nodes;
        for (const CutRun& run : cut.runs)
            for (std::uint32_t up = run.nodeIndex; up != noNode; up = octree_.node(up).parent)
                nodes.insert(up);
        return nodes.size() * 4;
    }
    /// Walks up from every leaf: what the wanted cut covers by a whole run, the drawn one does, too.
    void expectNoHoles(const Cut& wanted, const Cut& drawn) const {
        const auto wholeRuns = [&](const Cut& cut) {
            std::set<std::uint32_t> nodes;
            for (const CutRun& run : cut.runs)
                if (run.share == 1) nodes.insert(run.nodeIndex);
            return nodes;
        };
        const auto asked = wholeRuns(wanted), shown = wholeRuns(drawn);
        for (std::uint32_t leaf = 0; leaf < octree_.nodes().size(); ++leaf) {
            if (!octree_.node(leaf).isLeaf()) continue;
            int wants = 0, gets = 0;
            for (std::uint32_t up = leaf; up != noNode; up = octree_.node(up).parent) {
                wants += asked.contains(up);
                gets += shown.contains(up);
            }
            ASSERT_LE(gets, 1) << "leaf " << leaf;
            ASSERT_GE(gets, wants) << "leaf " << leaf;
        }
    }
};

TEST_F(OnDevice, PicturesOfARestingViewGetWholeWithoutHoles) {
    everythingIsInMemory();
    for (std::uint64_t i = 0; i < 40; ++i) {
        SCOPED_TRACE(i);
        const std::uint64_t budget = i == 7 ? 1 : std::array{41, 100, 800}[i % 3];
        ToyMemory memory(1'000'000, budget);
        const Cut wanted = i % 2 ? randomCut(i) : fadingCut(i);
        const std::uint64_t most = 2 + samplesUpTo(wanted) / std::max<std::uint64_t>(budget / 4 * 4, 4);
        std::uint64_t missing = samplesOf(wanted) + 1, frames = 0;
        while (missing > 0) {
            const std::uint64_t before = memory.moved;
            const Cut drawn = onDevice(wanted, memory);
            expectNoHoles(wanted, drawn);
            // The first brings the root, too, whatever the budget.
            ASSERT_LE(memory.moved - before, std::max<std::uint64_t>(budget, 4) + (frames == 0 ? 4 : 0));
            ASSERT_LE(drawn.samplesMissing, missing);
            ASSERT_EQ(drawn.nodesMissing * 4, drawn.samplesMissing);
            missing = drawn.samplesMissing;
            ASSERT_LE(++frames, most) << "each has as much more as the budget allows";
            if (missing == 0) {
                ASSERT_EQ(drawn.runs.size(), wanted.runs.size());
            }
        }
        const std::uint64_t before = memory.moved;
        ASSERT_EQ(onDevice(wanted, memory).samplesMissing, 0u);
        ASSERT_EQ(memory.moved, before) << "then nothing moves any more";
    }
}

// Oracle: provide() itself, asked of a store that holds what the device holds.
TEST_F(OnDevice, WhatStandsInIsWhatProvideWouldTake) {
    for (std::uint64_t i = 0; i < 60; ++i) {
        everythingIsInMemory();
        ToyMemory memory(1'000'000, 40);
        for (std::uint64_t k = 0; k < 5; ++k) onDevice(randomCut(7 * i + k), memory);
        const Cut wanted = i % 2 ? randomCut(i) : fadingCut(i);
        const Cut drawn = onDevice(wanted, memory);
        store_->resident = memory.held();
        const auto expected = provide(octree_, wanted, {.wait = false});
        ASSERT_TRUE(expected);
        ASSERT_EQ(drawn.runs.size(), expected->runs.size());
        for (std::size_t r = 0; r < drawn.runs.size(); ++r) {
            ASSERT_EQ(drawn.runs[r].nodeIndex, expected->runs[r].nodeIndex);
            ASSERT_EQ(drawn.runs[r].share, expected->runs[r].share);
            ASSERT_EQ(drawn.runs[r].covered, expected->runs[r].covered);
            ASSERT_EQ(drawn.runs[r].firstOrdinal, expected->runs[r].firstOrdinal);
            ASSERT_EQ(drawn.runs[r].projected, expected->runs[r].projected);
        }
        ASSERT_EQ(drawn.samplesMissing, expected->samplesMissing);
        ASSERT_EQ(drawn.points, expected->points);
    }
}

TEST_F(OnDevice, WhatDoesNotFitStaysCoarseAndMovesNothing) {
    everythingIsInMemory();
    for (std::uint64_t i = 0; i < 12; ++i) {
        const Cut wanted = randomCut(i);
        const std::uint64_t all = samplesOf(wanted);
        if (all < 40) continue;
        ToyMemory memory(all / 2, 100);
        std::uint64_t moved = 0;
        for (std::uint64_t frame = 0; frame < 12 + all / 100; ++frame) {
            moved = memory.moved;
            const Cut drawn = onDevice(wanted, memory);
            expectNoHoles(wanted, drawn);
            ASSERT_GT(drawn.samplesMissing, 0u);
            ASSERT_LE(samplesOf(drawn), memory.capacity());
        }
        EXPECT_EQ(memory.moved, moved) << "it is at rest";
    }
}

TEST_F(OnDevice, ASmallViewIsWholeAtOnceAndBringsNoAncestors) {
    everythingIsInMemory();
    const Cut wanted = randomCut(3);
    ToyMemory memory(1'000'000, samplesOf(wanted));
    EXPECT_EQ(onDevice(wanted, memory).samplesMissing, 0u);
    EXPECT_EQ(memory.moved, samplesOf(wanted));
}

TEST_F(OnDevice, ACameraThatMovesSeesNoHoles) {
    everythingIsInMemory();
    ToyMemory memory(300, 24);
    for (std::uint64_t i = 0; i < 60; ++i) {
        const Cut wanted = i % 2 ? randomCut(i) : fadingCut(i);
        expectNoHoles(wanted, onDevice(wanted, memory));
        ASSERT_LE(memory.used(), memory.capacity());
    }
}

// A picture and its mirrors share one budget, and what one shows the other has, too.
TEST_F(OnDevice, CutsOfOnePictureShareABudget) {
    everythingIsInMemory();
    ToyMemory memory(1'000'000, 40);
    Cut picture = filled(randomCut(5)), mirror = filled(randomCut(6));
    const Cut wanted[] = {picture, mirror};
    Cut* const cuts[] = {&picture, &mirror};
    ASSERT_TRUE(provideOnDevice(octree_, cuts, memory, {}));
    EXPECT_LE(memory.moved, 44u);
    for (int i = 0; i < 2; ++i) {
        expectNoHoles(wanted[i], *cuts[i]);
        memory.draw(octree_.source(), *cuts[i]);
    }
    EXPECT_LE(memory.moved, 44u) << "drawing them uploads nothing more";
}

}  // namespace
}  // namespace scancast
