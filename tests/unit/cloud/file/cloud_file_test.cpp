// A cloud that is written is the cloud that is read, to the last bit.
#include "renderer/cloud/file/cloud_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

void expectSame(const CloudFile& file, const Octree& octree, const CloudFacts& facts) {
    std::array<std::byte, nodeRecordBytes> written, read;
    ASSERT_EQ(file.nodes().size(), octree.nodes().size());
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        encodeNode({octree.node(i), file.nodes()[i].samples, file.nodes()[i].rows}, written);
        encodeNode(file.nodes()[i], read);
        ASSERT_EQ(written, read) << "node " << i;
        const auto samples = file.samples(i);
        ASSERT_TRUE(samples) << samples.error().message;
        const auto run = octree.run(i).value();
        ASSERT_EQ(samples->size(), run.samples.size());
        ASSERT_EQ(std::memcmp(samples->data(), run.samples.data(), run.samples.size_bytes()), 0)
            << "node " << i;
        const auto rows = file.rows(i);
        ASSERT_TRUE(rows) << rows.error().message;
        if (facts.columns.empty() || !octree.node(i).isLeaf())
            ASSERT_TRUE(rows->empty());
        else
            ASSERT_EQ(*rows, test::madeUpRows(i, run.samples.size(), 17)) << "node " << i;
    }
    test::expectSameFacts(file.facts(), facts);
}

// Right because every node, sample, row and fact is compared with what went in, bit by bit.
TEST(CloudFile, WhatIsWrittenIsRead) {
    const test::TemporaryFolder folder;
    for (const bool columns : {false, true}) {
        const auto cloud = test::sampleCloud();
        const CloudFacts facts = test::fullFacts(*cloud, columns);
        const auto path = folder.path() / (columns ? "columns.scan" : "plain.scan");
        const auto written = test::writeCloudFile(path, cloud->octree, facts);
        ASSERT_TRUE(written) << written.error().message;
        const auto file = CloudFile::open(path);
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_EQ((*file)->path(), path);
        EXPECT_EQ((*file)->bytes(), std::filesystem::file_size(path));
        EXPECT_EQ((*file)->writtenBy(), programName());
        expectSame(**file, cloud->octree, facts);
        EXPECT_FALSE(std::filesystem::exists(path.string() + ".partial"));
    }
}

TEST(CloudFile, TheSameCloudGivesTheSameBytes) {
    const test::TemporaryFolder folder;
    const auto cloud = test::sampleCloud();
    for (const char* name : {"a.scan", "b.scan"})
        ASSERT_TRUE(test::writeCloudFile(folder.path() / name, cloud->octree, *cloud));
    EXPECT_EQ(test::fileBytes(folder.path() / "a.scan"), test::fileBytes(folder.path() / "b.scan"));
}

TEST(CloudFile, IsRecognisedByItsStart) {
    const auto bytes = test::sampleFile();
    EXPECT_TRUE(isCloudFile(bytes));
    EXPECT_FALSE(isCloudFile(std::span(bytes).first(7)));
    EXPECT_FALSE(isCloudFile({}));
}

TEST(CloudFile, WhatIsNoCloudFileSaysSo) {
    const test::TemporaryFolder folder;
    const auto missing = CloudFile::open(folder.path() / "none.scan");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::NotFound);
    const auto directory = CloudFile::open(folder.path());
    ASSERT_FALSE(directory);
    EXPECT_EQ(directory.error().code, ErrorCode::Unsupported);
    for (const char* content : {"", "LASF", "ply\nformat ascii 1.0\n"}) {
        const auto other = CloudFile::open(folder.write("other.las", content));
        ASSERT_FALSE(other);
        EXPECT_EQ(other.error().code, ErrorCode::Unsupported) << other.error().message;
        EXPECT_NE(other.error().message.find("other.las, byte 0"), std::string::npos)
            << other.error().message;
        EXPECT_NE(other.error().message.find("scancast ingest"), std::string::npos) << other.error().message;
    }
}

TEST(CloudFile, ANodeThatThereIsNotIsAnError) {
    const auto bytes = test::sampleFile();
    const auto file = test::openBytes(bytes).value();
    const auto samples = file->samples(std::uint32_t(file->nodes().size()));
    ASSERT_FALSE(samples);
    EXPECT_EQ(samples.error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace scancast
