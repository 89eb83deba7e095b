#include "renderer/residency/block_table.hpp"

#include <gtest/gtest.h>

#include "tests/support/clouds/fake_cloud_file.hpp"

namespace scancast {
namespace {

constexpr std::uint32_t samples = 1000;
constexpr std::uint64_t blockBytes = samples * sizeof(Sample) + limitsBytes(samples) + 128;

class Table : public testing::Test {
  protected:
    Table() : file_(std::make_shared<test::FakeCloudFile>(1, 4, samples)) {}

    bool load(std::uint32_t node, BlockTable::Time now, bool must = false) {
        auto block = table_.beginLoad(*cloud_, node, must, now);
        if (!block) return false;
        block->samples = *file_->samples(node);
        table_.finishLoad(*cloud_, node, std::move(block), now);
        return true;
    }
    bool here(std::uint32_t node) { return table_.state(*cloud_, node, 1'000'000) == BlockState::Resident; }
    std::uint32_t parent(std::uint32_t node) { return file_->nodes()[node].node.parent; }
    std::uint32_t last() const { return std::uint32_t(file_->nodes().size()) - 1; }

    std::shared_ptr<test::FakeCloudFile> file_;
    BlockTable table_{10 * blockBytes, 100};
    std::shared_ptr<BlockTable::CloudBlocks> cloud_ = table_.add(file_, 0);
};

TEST_F(Table, TheLeastRecentlyUsedGoesFirst) {
    const std::uint32_t first = last() - 20;
    for (std::uint32_t i = 0; i < 10; ++i) ASSERT_TRUE(load(first + i, 1000 * i));
    EXPECT_EQ(table_.bytes(), 10 * blockBytes);
    ASSERT_TRUE(table_.use(*cloud_, first, 20'000));
    ASSERT_TRUE(load(first + 10, 30'000));
    EXPECT_TRUE(here(first));
    EXPECT_FALSE(here(first + 1));
    EXPECT_TRUE(here(first + 2));
    EXPECT_EQ(table_.bytes(), 10 * blockBytes);
    EXPECT_EQ(table_.evicted(), 1u);
}

TEST_F(Table, AncestorsCountAsUsed) {
    const std::uint32_t node = last(), up = parent(node);
    ASSERT_TRUE(load(up, 0));
    ASSERT_TRUE(load(node, 1));
    std::uint32_t other = up + 1;
    for (int i = 0; i < 8; ++i, ++other) ASSERT_TRUE(load(other, 1000 + i));
    table_.use(*cloud_, node, 5000);
    ASSERT_TRUE(load(other, 6000));
    ASSERT_TRUE(load(other + 1, 6000));
    EXPECT_TRUE(here(up));
    EXPECT_TRUE(here(node));
}

TEST_F(Table, TheRootIsPinned) {
    ASSERT_TRUE(load(0, 0));
    for (std::uint32_t i = 1; i < 40; ++i) ASSERT_TRUE(load(i, 1000 * i));
    EXPECT_TRUE(here(0));
    EXPECT_EQ(table_.bytes(), 10 * blockBytes);
}

TEST_F(Table, WhatSomebodyHoldsIsCountedAndStays) {
    const std::uint32_t first = last() - 30;
    std::vector<std::shared_ptr<const Block>> held;
    for (std::uint32_t i = 0; i < 10; ++i) {
        ASSERT_TRUE(load(first + i, i));
        held.push_back(table_.use(*cloud_, first + i, i));
    }
    EXPECT_FALSE(load(first + 10, 50'000)) << "nothing may be evicted, so there is no room";
    ASSERT_TRUE(load(first + 10, 50'000, true)) << "what must be loaded is";
    EXPECT_EQ(table_.bytes(), 11 * blockBytes);
    held.clear();
    ASSERT_TRUE(load(first + 11, 60'000));
    EXPECT_LE(table_.bytes(), 10 * blockBytes) << "back below the limit with the next load";
}

TEST_F(Table, ABlockThatOutlivesItsCloudIsStillCounted) {
    ASSERT_TRUE(load(0, 0));
    auto held = table_.use(*cloud_, 0, 0);
    table_.remove(*cloud_);
    EXPECT_EQ(table_.bytes(), blockBytes);
    EXPECT_EQ(held->samples.size(), samples);
    held.reset();
    EXPECT_EQ(table_.bytes(), 0u);
}

TEST_F(Table, WithinTheGraceTimeOnlyWhatMustBeLoadedEvicts) {
    for (std::uint32_t i = 1; i <= 10; ++i) ASSERT_TRUE(load(i, 1000));
    EXPECT_FALSE(load(11, 1050));
    EXPECT_TRUE(load(11, 1050, true));
    EXPECT_TRUE(load(12, 1101));
}

TEST_F(Table, DamageStaysUnlessItMayPass) {
    ASSERT_TRUE(table_.beginLoad(*cloud_, 1, false, 0));
    table_.failLoad(*cloud_, 1, Error{ErrorCode::Malformed, "broken", {}}, 0);
    ASSERT_TRUE(table_.beginLoad(*cloud_, 2, false, 0));
    table_.failLoad(*cloud_, 2, Error{ErrorCode::Io, "the disk was away", {}}, 0);
    EXPECT_EQ(table_.state(*cloud_, 1, 100), BlockState::Damaged);
    EXPECT_EQ(table_.state(*cloud_, 2, 100), BlockState::Damaged);
    EXPECT_EQ(table_.state(*cloud_, 1, 1'000'000), BlockState::Damaged);
    EXPECT_EQ(table_.state(*cloud_, 2, 1'000'000), BlockState::Absent);
    EXPECT_EQ(table_.bytes(), 0u);
}

TEST_F(Table, DamageIsToldOnceAnHour) {
    constexpr BlockTable::Time minute = 60'000;
    int told = 0;
    for (BlockTable::Time now = 0; now < 150 * minute; now += minute) {
        ASSERT_EQ(table_.state(*cloud_, 2, now), BlockState::Absent) << "it is tried again";
        ASSERT_TRUE(table_.beginLoad(*cloud_, 2, false, now));
        told += table_.failLoad(*cloud_, 2, Error{ErrorCode::Io, "the disk was away", {}}, now);
    }
    EXPECT_EQ(told, 3);
    ASSERT_TRUE(table_.beginLoad(*cloud_, 3, false, 0));
    EXPECT_TRUE(table_.failLoad(*cloud_, 3, Error{ErrorCode::Io, "the disk was away", {}}, 0))
        << "another block";
}

// Right because it keeps its own book of what is alive; the table is told nothing of it.
TEST_F(Table, TheBooksBalanceWhateverHappens) {
    std::vector<std::shared_ptr<const Block>> held;
    std::uint64_t beyond = 0;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        const auto node = std::uint32_t(test::uniform(i, 1) * double(last()));
        const auto now = BlockTable::Time(i * 7);
        if (auto block = table_.use(*cloud_, node, now)) {
            if (test::uniform(i, 2) < 0.3 && held.size() < 6) held.push_back(std::move(block));
        } else {
            load(node, now, test::uniform(i, 3) < 0.2);
        }
        if (test::uniform(i, 4) < 0.1 && !held.empty()) held.erase(held.begin());
        std::uint64_t resident = 0;
        for (std::uint32_t n = 0; n <= last(); ++n) resident += here(n) ? blockBytes : 0;
        ASSERT_EQ(table_.bytes(), resident) << "held blocks are never evicted, so all that lives is resident";
        ASSERT_EQ(cloud_->bytes, resident);
        ASSERT_LE(table_.bytes(), 10 * blockBytes) << "six held leave room for one more";
        beyond += held.size() == 6;
    }
    EXPECT_GT(beyond, 100u);
    EXPECT_GT(table_.evicted(), 1000u);
}

}  // namespace
}  // namespace scancast
