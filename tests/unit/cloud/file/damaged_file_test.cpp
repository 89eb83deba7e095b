// Damage of any kind: an error that names the file, what is damaged and where; the rest stays readable.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/sized.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

TEST(DamagedFile, EveryByteOutsideOfBlocksMatters) {
    auto bytes = test::sampleFile();
    const auto header = parseHeader(std::span(bytes).first(cloudHeaderBytes), bytes.size()).value();
    ASSERT_TRUE(test::openBytes(bytes));
    for (std::size_t at = 0; at < bytes.size(); at += test::sized(1, 5)) {
        if (at >= cloudHeaderBytes) at = std::max(at, std::size_t(header.index.offset));
        for (const int bit : {0, 7}) {
            const auto flip = std::byte(1 << bit);
            bytes[at] ^= flip;
            const auto file = test::openBytes(bytes);
            ASSERT_FALSE(file) << "byte " << at << " can be changed unnoticed";
            EXPECT_TRUE(file.error().message.starts_with("memory.scan, ")) << file.error().message;
            bytes[at] ^= flip;
        }
    }
}

TEST(DamagedFile, EveryLengthButItsOwnIsAnError) {
    const auto bytes = test::sampleFile();
    for (std::size_t length = 0; length < bytes.size();
         length += length < 300 || length + 6000 > bytes.size() ? 1 : 97) {
        const auto file = test::openBytes(std::span(bytes).first(length));
        ASSERT_FALSE(file) << length;
        EXPECT_EQ(file.error().code, length < 8 ? ErrorCode::Unsupported : ErrorCode::Truncated) << length;
        if (length >= 8) {
            EXPECT_NE(file.error().message.find(std::to_string(length)), std::string::npos) << length;
        }
    }
}

// What an interrupted change of facts left there.
TEST(DamagedFile, WhatStandsBehindTheFactsMeansNothing) {
    auto bytes = test::sampleFile();
    bytes.resize(bytes.size() + 4711, std::byte(0x5a));
    const auto file = test::openBytes(bytes);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ((*file)->facts().title, test::fullFacts({}, false).title);
}

TEST(DamagedFile, AnotherVersionSaysWhatToDo) {
    auto bytes = test::sampleFile();
    for (const int version : {0, 4, 255}) {
        bytes[8] = std::byte(version);
        const auto file = test::openBytes(bytes);
        ASSERT_FALSE(file);
        EXPECT_EQ(file.error().code, ErrorCode::Unsupported);
        EXPECT_NE(file.error().message.find("version " + std::to_string(version)), std::string::npos);
        EXPECT_NE(file.error().message.find("ingest"), std::string::npos) << file.error().message;
    }
}

TEST(DamagedFile, AnEmptyHeaderMeansUnfinished) {
    const std::vector<std::byte> zeros(5000);
    const auto file = test::openBytes(zeros);
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::Truncated);
    EXPECT_NE(file.error().message.find("never finished"), std::string::npos) << file.error().message;
}

TEST(DamagedFile, OneDamagedBlockCostsOneNode) {
    const auto sound = test::sampleFile();
    const auto nodes = test::openBytes(sound).value();
    for (std::uint32_t hit = 0; hit < nodes->nodes().size(); hit += 5) {
        auto bytes = sound;
        const BlockPlace place = nodes->nodes()[hit].samples;
        bytes[place.offset + place.bytes / 2] ^= std::byte(1);
        const auto file = test::openBytes(bytes);
        ASSERT_TRUE(file) << file.error().message;
        for (std::uint32_t i = 0; i < nodes->nodes().size(); ++i) {
            const auto samples = (*file)->samples(i);
            EXPECT_EQ(samples.has_value(), i != hit) << "node " << i;
            EXPECT_TRUE((*file)->rows(i)) << "node " << i;
            if (samples) continue;
            EXPECT_EQ(samples.error().code, ErrorCode::Malformed);
            const auto where = "memory.scan, node " + std::to_string(hit) + ", samples at byte " +
                               std::to_string(place.offset);
            EXPECT_TRUE(samples.error().message.starts_with(where)) << samples.error().message;
        }
    }
}

TEST(DamagedFile, ADamagedPlaneLeavesTheOthers) {
    auto bytes = test::sampleFile();
    const auto nodes = test::openBytes(bytes).value();
    const auto leaf = std::uint32_t(nodes->nodes().size() - 1);
    bytes[nodes->planePlace(leaf, 1).offset] ^= std::byte(128);
    const auto file = test::openBytes(bytes).value();
    EXPECT_TRUE(file->samples(leaf));
    for (std::size_t p = 0; p < file->planes().size(); ++p)
        EXPECT_EQ(file->plane(leaf, p).has_value(), p != 1);
    for (const auto& damaged : {file->plane(leaf, 1), file->rows(leaf)}) {
        ASSERT_FALSE(damaged);
        EXPECT_EQ(damaged.error().code, ErrorCode::Malformed);
        EXPECT_NE(damaged.error().message.find("plane return_number at byte"), std::string::npos)
            << damaged.error().message;
    }
}

// A map of the file would end in a signal here.
TEST(DamagedFile, CutShortAfterOpening) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "cut.scan";
    const auto cloud = test::sampleCloud();
    ASSERT_TRUE(test::writeCloudFile(path, cloud->octree, *cloud));
    const auto file = CloudFile::open(path).value();
    const BlockPlace last = file->nodes().back().samples;
    std::filesystem::resize_file(path, last.offset + 1);
    EXPECT_TRUE(file->samples(0));
    const auto samples = file->samples(std::uint32_t(file->nodes().size() - 1));
    ASSERT_FALSE(samples);
    EXPECT_EQ(samples.error().code, ErrorCode::Truncated);
    EXPECT_NE(samples.error().message.find("ends at byte " + std::to_string(last.offset + 1)),
              std::string::npos);
}

}  // namespace
}  // namespace scancast
