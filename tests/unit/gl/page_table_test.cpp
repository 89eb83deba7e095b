#include "renderer/device/gl/memory/page_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "renderer/cloud/sample.hpp"

namespace scancast::gl {
namespace {

constexpr std::uint32_t grain = PageTable::grain;
constexpr std::uint32_t nobody = 0xffffffff;

std::uint32_t grainsFor(std::uint32_t samples) {
    return (samples + grain - 1) / grain;
}

/// What a page table promises, said in the plainest way: every grain has at most one owner, and a list says
/// who was used when.
class Model {
  public:
    explicit Model(const std::vector<std::uint32_t>& pageSamples) {
        for (const std::uint32_t samples : pageSamples) pages_.emplace_back(samples / grain, nobody);
    }

    std::uint32_t free() const {
        std::uint32_t count = 0;
        for (const auto& page : pages_) count += static_cast<std::uint32_t>(std::ranges::count(page, nobody));
        return count;
    }
    bool has(std::uint32_t run) const { return std::ranges::find(order_, run) != order_.end(); }
    void use(std::uint32_t run) {
        std::erase(order_, run);
        order_.push_back(run);
    }
    void need(std::uint32_t run) {
        use(run);
        needed_.insert(run);
    }
    void beginBatch() { needed_.clear(); }
    void erase(std::uint32_t run) {
        std::erase(order_, run);
        needed_.erase(run);
        for (auto& page : pages_) std::ranges::replace(page, run, nobody);
    }
    /// Least recently used out until it fits; false when only needed ones are left.
    bool makeRoom(std::uint32_t grains) {
        while (free() < grains) {
            if (order_.empty() || needed_.contains(order_.front())) return false;
            erase(order_.front());
        }
        return true;
    }
    void own(std::uint32_t run, std::span<const Place> places, std::uint32_t samples) {
        std::uint32_t left = samples;
        for (const Place& place : places) {
            ASSERT_GT(place.count, 0u);
            ASSERT_LE(place.count, left);
            left -= place.count;
            // All but the last fill their grains.
            if (left > 0) {
                ASSERT_EQ(place.count % grain, 0u);
            }
            ASSERT_EQ(place.at % grain, 0u);
            ASSERT_LT(place.page, pages_.size());
            for (std::uint32_t g = place.at / grain; g < place.at / grain + grainsFor(place.count); ++g) {
                ASSERT_LT(g, pages_[place.page].size()) << "it reaches beyond its page";
                ASSERT_EQ(pages_[place.page][g], nobody) << "two own the same place";
                pages_[place.page][g] = run;
            }
        }
        ASSERT_EQ(left, 0u);
    }
    void close(std::uint32_t page) {
        const auto owners = pages_[page];
        for (const std::uint32_t owner : owners)
            if (owner != nobody) erase(owner);
        pages_[page].clear();
    }
    /// The longest row of free grains.
    std::uint32_t largestHole() const {
        std::uint32_t largest = 0;
        for (const auto& page : pages_) {
            std::uint32_t row = 0;
            for (const std::uint32_t owner : page)
                largest = std::max(largest, row = owner == nobody ? row + 1 : 0);
        }
        return largest;
    }

  private:
    std::vector<std::vector<std::uint32_t>> pages_;  // whose each grain is
    std::vector<std::uint32_t> order_;               // the least recently used first
    std::set<std::uint32_t> needed_;
};

/// Oracle: a model that looks at every grain, over random batches with as little room as half a batch needs.
TEST(PageTable, DoesWhatAModelDoesThatLooksAtEveryGrain) {
    std::mt19937 random(7);
    const auto upTo = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1)); };
    for (int round = 0; round < 40; ++round) {
        std::vector<std::uint32_t> pages;
        for (std::uint32_t i = 0; i <= upTo(4); ++i) pages.push_back((1 + upTo(30)) * grain);
        PageTable table(pages);
        Model model(pages);
        const std::uint32_t capacity = std::accumulate(pages.begin(), pages.end(), 0u);
        ASSERT_EQ(table.capacity(), capacity);
        std::map<std::uint32_t, std::uint32_t> sizes;
        for (std::uint32_t run = 0; run < 60; ++run) sizes[run] = 1 + upTo(6 * grain);
        for (int step = 0; step < 400; ++step) {
            std::vector<std::uint32_t> batch(1 + upTo(12));
            for (std::uint32_t& run : batch) run = upTo(59);
            std::ranges::sort(batch);
            batch.erase(std::unique(batch.begin(), batch.end()), batch.end());
            for (const std::uint32_t run : batch) {
                ASSERT_EQ(table.touch({1, run, 0}), model.has(run));
                if (model.has(run)) model.use(run);
            }
            table.beginBatch();
            model.beginBatch();
            for (const std::uint32_t run : batch) {
                const SampleKey key{1, run, 0};
                ASSERT_EQ(table.has(key), model.has(run));
                if (model.has(run)) {
                    ASSERT_FALSE(table.need(key).empty());
                    model.need(run);
                    continue;
                }
                const std::uint32_t grains = grainsFor(sizes[run]);
                const bool fits = model.makeRoom(grains);
                const bool inOne = fits && model.largestHole() >= grains;
                const auto places = table.insert(key, sizes[run]);
                ASSERT_EQ(!places.empty(), fits);
                if (!fits) break;
                if (inOne) {
                    ASSERT_EQ(places.size(), 1u) << "there was a hole for all of it";
                }
                model.own(run, places, sizes[run]);
                model.need(run);
            }
            if (upTo(9) == 0) {
                const std::uint32_t gone = upTo(59);
                table.erase({1, gone, 0});
                model.erase(gone);
            }
            if (upTo(199) == 0 && table.pages() > 1) {
                const std::uint32_t page = upTo(table.pages() - 1);
                table.close(page);
                model.close(page);
            }
            ASSERT_EQ(table.capacity() - table.used(), std::uint64_t(model.free()) * grain);
            for (const auto& [run, size] : sizes) ASSERT_EQ(table.has({1, run, 0}), model.has(run));
        }
    }
}

TEST(PageTable, NothingThatABatchNeedsGoes) {
    PageTable table({4 * grain});
    table.beginBatch();
    for (std::uint32_t run = 0; run < 4; ++run) ASSERT_FALSE(table.insert({1, run, 0}, grain).empty());
    EXPECT_TRUE(table.insert({1, 4, 0}, 1).empty());
    for (std::uint32_t run = 0; run < 4; ++run) EXPECT_TRUE(table.has({1, run, 0}));
    table.beginBatch();
    EXPECT_FALSE(table.insert({1, 4, 0}, 1).empty());
    EXPECT_FALSE(table.has({1, 0, 0})) << "the least recently used";
    EXPECT_EQ(table.evicted(), 1u);
}

TEST(PageTable, WhatIsScatteredIsUsed) {
    PageTable table({4 * grain, 2 * grain});
    table.beginBatch();
    for (std::uint32_t run = 0; run < 6; ++run) ASSERT_FALSE(table.insert({1, run, 0}, grain).empty());
    for (const std::uint32_t run : {1u, 3u, 5u}) table.erase({1, run, 0});
    const auto places = table.insert({2, 0, 0}, 3 * grain - 1);
    EXPECT_EQ(places.size(), 3u);
    EXPECT_EQ(table.evicted(), 0u);
    EXPECT_EQ(table.used(), table.capacity());
}

TEST(PageTable, TellsWhetherAnythingWasUsed) {
    PageTable table({4 * grain});
    table.insert({1, 0, 0}, grain);
    table.insert({1, 1, 0}, grain);
    const std::uint64_t before = table.uses();
    EXPECT_TRUE(table.has({1, 0, 0}));
    EXPECT_FALSE(table.touch({1, 2, 0}));
    EXPECT_FALSE(table.need({1, 1, 0}).empty());
    EXPECT_EQ(table.uses(), before) << "what was used last is so still";
    EXPECT_TRUE(table.touch({1, 0, 0}));
    EXPECT_NE(table.uses(), before);
}

TEST(PageTable, OctreesAndPartsOfNodesAreToldApart) {
    PageTable table({8 * grain});
    table.insert({1, 5, 0}, 10);
    EXPECT_FALSE(table.has({2, 5, 0}));
    EXPECT_FALSE(table.has({1, 5, 256}));
    EXPECT_TRUE(table.need({2, 5, 0}).empty());
    EXPECT_FALSE(table.touch({1, 6, 0}));
    EXPECT_TRUE(table.has({1, 5, 0}));
}

TEST(PageTable, PagesDoubleUpToTheLargestAndKeepTheLimit) {
    constexpr std::uint64_t mib = 1 << 20;
    const auto inMib = [](std::uint64_t limit, std::uint64_t first, std::uint64_t most) {
        std::vector<std::uint64_t> sizes;
        for (const std::uint32_t samples : pageSizes(limit * mib, first * mib, most * mib))
            sizes.push_back(samples * sizeof(Sample) / mib);
        return sizes;
    };
    EXPECT_EQ(inMib(512, 32, 128), (std::vector<std::uint64_t>{32, 64, 128, 128, 128, 32}));
    EXPECT_EQ(inMib(300, 128, 128), (std::vector<std::uint64_t>{128, 128, 44}));
    EXPECT_EQ(inMib(20, 32, 128), (std::vector<std::uint64_t>{20}));
    EXPECT_EQ(inMib(9000, 128, 2048),
              (std::vector<std::uint64_t>{128, 256, 512, 1024, 2048, 2048, 2048, 936}));
    EXPECT_EQ(pageSizes(1, 1, 1), std::vector<std::uint32_t>{grain}) << "something must be drawn with";
    for (const std::uint64_t limit : {10'000'000ull, 123'456'789ull, 77'000'000'000ull}) {
        std::uint64_t all = 0;
        for (const std::uint32_t samples : pageSizes(limit, 32 * mib, 128 * mib))
            all += samples * sizeof(Sample);
        EXPECT_LE(all, limit);
        EXPECT_GT(all + grain * sizeof(Sample), limit);
    }
}

}  // namespace
}  // namespace scancast::gl
