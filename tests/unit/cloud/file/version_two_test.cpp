// Files of version 2, whose indices are not packed, open as newer ones do. Nothing writes them any more: version_two.hpp
// of tests/support/clouds makes them.
#include "tests/support/clouds/version_two.hpp"

#include <gtest/gtest.h>

#include "renderer/cloud/file/change_facts.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

// Right because the newer file was made of the same cloud, and is compared with it by its own tests.
TEST(VersionTwo, IsReadAsNewerOnesAre) {
    for (const bool columns : {false, true}) {
        const auto newer = test::sampleFile(columns), bytes = test::asVersionTwo(newer);
        EXPECT_EQ(bytes[8], std::byte(2));
        const auto opened = test::openBytes(bytes);
        ASSERT_TRUE(opened) << opened.error().message;
        const CloudFile& file = **opened;
        const auto same = test::openBytes(newer).value();
        EXPECT_EQ(test::nodeRecords(file.nodes()), test::nodeRecords(same->nodes()));
        EXPECT_EQ(test::planePlaces(file), test::planePlaces(*same));
        EXPECT_EQ(file.planes().size(), columns ? 5u : 0u);
        for (std::uint32_t i = 0; i < file.nodes().size(); ++i) {
            const auto samples = file.samples(i).value(), others = same->samples(i).value();
            ASSERT_EQ(std::memcmp(samples.data(), others.data(), others.size() * sizeof(Sample)), 0);
            EXPECT_EQ(file.rows(i).value(), same->rows(i).value()) << "node " << i;
        }
        test::expectSameFacts(file.facts(), same->facts());
    }
}

TEST(VersionTwo, DamageIsFound) {
    const auto sound = test::asVersionTwo(test::sampleFile());
    const auto header = parseHeader(std::span(sound).first(cloudHeaderBytes), sound.size()).value();
    EXPECT_EQ(header.version, 2u);
    EXPECT_EQ(header.index.bytes, header.nodes * nodeRecordBytes);
    for (std::size_t at = 0; at < sound.size(); at += test::sized(9, 45)) {
        if (at >= cloudHeaderBytes) at = std::max(at, std::size_t(header.index.offset));
        auto bytes = sound;
        bytes[at] ^= std::byte(4);
        EXPECT_FALSE(test::openBytes(bytes)) << "byte " << at << " can be changed unnoticed";
    }
}

TEST(VersionTwo, WhatMustBeZeroIsLookedAt) {
    const auto honest = test::asVersionTwo(test::sampleFile());
    const auto header = parseHeader(std::span(honest).first(cloudHeaderBytes), honest.size()).value();
    const auto parts = test::partsOf(honest);
    const auto blocks = std::span(honest).first(header.index.offset),
               facts = std::span(honest).subspan(header.facts.offset);
    const auto nodes = test::nodeRecords(parts.nodes), planes = test::planeRecords(parts.planes);
    ASSERT_EQ(test::versionTwoFile(blocks, nodes, planes, facts), honest);
    for (const std::size_t at : {143, 184, 207}) {
        auto other = nodes;
        other[nodeRecordBytes + at] = std::byte(1);
        const auto file = test::openBytes(test::versionTwoFile(blocks, other, planes, facts));
        ASSERT_FALSE(file) << at;
        EXPECT_NE(file.error().message.find("index of nodes has something where zeros"), std::string::npos)
            << file.error().message;
    }
    auto other = planes;
    other[planeRecordBytes + 20] = std::byte(1);
    EXPECT_FALSE(test::openBytes(test::versionTwoFile(blocks, nodes, other, facts)));
}

// Indices stay as they are, so the version does, too.
TEST(VersionTwo, ItsFactsChangeInPlace) {
    const test::TemporaryFolder folder;
    const auto bytes = test::asVersionTwo(test::sampleFile());
    const auto path = folder.write("old.scan", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    CloudFacts facts = CloudFile::open(path).value()->facts();
    facts.title = "another title";
    for (int times = 0; times < 2; ++times) {
        const auto changed = rewriteFacts(path, facts);
        ASSERT_TRUE(changed) << changed.error().message;
        const auto now = test::fileBytes(path);
        EXPECT_EQ(parseHeader(std::span(now).first(cloudHeaderBytes), now.size()).value().version, 2u);
        EXPECT_TRUE(
            std::equal(bytes.begin() + cloudHeaderBytes, bytes.end(), now.begin() + cloudHeaderBytes));
        const auto file = CloudFile::open(path);
        ASSERT_TRUE(file) << file.error().message;
        test::expectSameFacts((*file)->facts(), facts);
        facts.title = "and another one";
    }
}

}  // namespace
}  // namespace scancast
