// Files of version 1 open as newer ones do. Nothing writes them any more: version_one.hpp of
// tests/support/clouds makes them.
#include "tests/support/clouds/version_one.hpp"

#include <gtest/gtest.h>

#include "renderer/cloud/file/change_facts.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

std::vector<std::byte> oldFile(bool columns) {
    return test::asVersionOne(*test::openBytes(test::sampleFile(columns)).value());
}

// Right because the newer file was made of the same cloud, and is compared with it by its own tests.
TEST(VersionOne, IsReadAsNewerOnesAre) {
    for (const bool columns : {false, true}) {
        const auto bytes = oldFile(columns), newer = test::sampleFile(columns);
        EXPECT_EQ(bytes[8], std::byte(1));
        const auto opened = test::openBytes(bytes);
        ASSERT_TRUE(opened) << opened.error().message;
        const CloudFile& file = **opened;
        const auto same = test::openBytes(newer).value();
        ASSERT_EQ(file.nodes().size(), same->nodes().size());
        ASSERT_EQ(file.planes().size(), columns ? 3u : 0u) << "companions are newer";
        for (std::uint32_t i = 0; i < file.nodes().size(); ++i) {
            const auto samples = file.samples(i).value(), others = same->samples(i).value();
            ASSERT_EQ(std::memcmp(samples.data(), others.data(), others.size() * sizeof(Sample)), 0);
            EXPECT_EQ(file.rows(i).value(), same->rows(i).value()) << "node " << i;
            for (std::size_t p = 0; p < file.planes().size(); ++p) {
                EXPECT_EQ(file.planes()[p], same->planes()[p]);
                EXPECT_EQ(file.plane(i, p).value(), same->plane(i, p).value()) << "node " << i;
            }
        }
        auto facts = same->facts();
        facts.companions.clear();
        facts.photos.clear();
        test::expectSameFacts(file.facts(), facts);
    }
}

TEST(VersionOne, NormalsOfAnOrientedCloudAreCertain) {
    const auto file = test::openBytes(oldFile(true)).value();
    ASSERT_TRUE(file->facts().oriented);
    for (const StoredNode& stored : file->nodes()) EXPECT_EQ(stored.node.confidence, certainSide);
}

TEST(VersionOne, DamageIsFound) {
    const auto sound = oldFile(true);
    const auto header = parseHeader(std::span(sound).first(cloudHeaderBytes), sound.size()).value();
    EXPECT_EQ(header.version, 1u);
    for (std::size_t at = 0; at < sound.size(); at += 3) {
        if (at >= cloudHeaderBytes) at = std::max(at, std::size_t(header.index.offset));
        auto bytes = sound;
        bytes[at] ^= std::byte(4);
        EXPECT_FALSE(test::openBytes(bytes)) << "byte " << at << " can be changed unnoticed";
    }
    auto longer = sound;
    longer.push_back(std::byte(0));
    EXPECT_FALSE(test::openBytes(longer)) << "its facts end with the file";
}

TEST(VersionOne, ADamagedBlockOfRowsIsNamed) {
    auto bytes = oldFile(true);
    const auto nodes = test::openBytes(bytes).value();
    const auto leaf = std::uint32_t(nodes->nodes().size() - 1);
    EXPECT_EQ(nodes->planePlace(leaf, 0), nodes->planePlace(leaf, 2)) << "columns share a block";
    bytes[nodes->planePlace(leaf, 0).offset] ^= std::byte(128);
    const auto file = test::openBytes(bytes).value();
    EXPECT_TRUE(file->samples(leaf));
    for (const auto& damaged : {file->rows(leaf), file->plane(leaf, 2)}) {
        ASSERT_FALSE(damaged);
        EXPECT_NE(damaged.error().message.find("rows at byte"), std::string::npos) << damaged.error().message;
    }
}

TEST(VersionOne, LiesAboutRowsAreFound) {
    const auto sound = oldFile(true);
    const auto header = parseHeader(std::span(sound).first(cloudHeaderBytes), sound.size()).value();
    const auto open = [&](std::size_t at, std::uint64_t value) {
        auto bytes = sound;
        storeLe(&bytes[header.index.offset + at], value);
        auto changed = header;
        changed.index.checksum =
            checksumOf(std::span(bytes).subspan(header.index.offset, header.index.bytes));
        const auto start = test::versionOneHeader(changed);
        std::copy(start.begin(), start.end(), bytes.begin());
        return test::openBytes(bytes);
    };
    const std::size_t last = (header.nodes - 1) * nodeRecordBytes;
    const auto original = [&](std::size_t at) {
        return loadLe<std::uint64_t>(&sound[header.index.offset + at]);
    };
    ASSERT_TRUE(open(last + 184, original(last + 184))) << "the forger must be good";
    EXPECT_FALSE(open(184, original(last + 184))) << "rows of an inner node";
    EXPECT_FALSE(open(last + 184, 0)) << "rows in the header";
    EXPECT_FALSE(open(last + 200, 0)) << "no rows";
    EXPECT_FALSE(open(last + 200, original(last + 200) | std::uint64_t(1) << 32)) << "something behind them";
    EXPECT_FALSE(open(last + 136, original(last + 136) | std::uint64_t(1) << 48)) << "a confidence";
}

TEST(VersionOne, ItsFactsCannotBeChanged) {
    const test::TemporaryFolder folder;
    const auto bytes = oldFile(true);
    const auto path = folder.write("old.scan", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto changed = rewriteFacts(path, CloudFile::open(path).value()->facts());
    ASSERT_FALSE(changed);
    EXPECT_EQ(changed.error().code, ErrorCode::Unsupported);
    EXPECT_NE(changed.error().message.find("ingest the scan again"), std::string::npos)
        << changed.error().message;
    EXPECT_EQ(test::fileBytes(path), bytes);
}

}  // namespace
}  // namespace scancast
