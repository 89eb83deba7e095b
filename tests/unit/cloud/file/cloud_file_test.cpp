// A cloud that is written is the cloud that is read, to the last bit.
#include "renderer/cloud/file/cloud_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

void expectSameNodes(const CloudFile& file, const Octree& octree) {
    std::array<std::byte, nodeRecordBytes> written, read;
    ASSERT_EQ(file.nodes().size(), octree.nodes().size());
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        encodeNode({octree.node(i), file.nodes()[i].samples}, written);
        encodeNode(file.nodes()[i], read);
        ASSERT_EQ(written, read) << "node " << i;
        const auto samples = file.samples(i);
        ASSERT_TRUE(samples) << samples.error().message;
        const auto run = octree.run(i).value();
        ASSERT_EQ(samples->size(), run.samples.size());
        ASSERT_EQ(std::memcmp(samples->data(), run.samples.data(), run.samples.size_bytes()), 0)
            << "node " << i;
    }
}

/// Columns one by one and as rows; a row has a double, a byte and a 64-bit number.
void expectSameColumns(const CloudFile& file) {
    const std::array<PlaceInRow, 3> places{{{0, 8, 17}, {8, 1, 17}, {9, 8, 17}}};
    for (std::uint32_t i = 0; i < file.nodes().size(); ++i) {
        const Node& node = file.nodes()[i].node;
        const auto expected = node.isLeaf() && !file.facts().columns.empty()
                                  ? test::madeUpRows(i, node.sampleCount, 17)
                                  : std::vector<std::byte>();
        const auto rows = file.rows(i);
        ASSERT_TRUE(rows) << rows.error().message;
        ASSERT_EQ(*rows, expected) << "node " << i;
        for (std::size_t c = 0; c < file.facts().columns.size(); ++c) {
            const auto values = file.plane(i, c);
            ASSERT_TRUE(values) << values.error().message;
            ASSERT_EQ(*values, takeColumn(expected, places[c])) << "node " << i << ", column " << c;
        }
    }
}

void expectSameCompanions(const CloudFile& file) {
    std::size_t inner = 0;
    for (std::uint32_t i = 0; i < file.nodes().size(); ++i)
        for (std::size_t p = file.facts().columns.size(); p < file.planes().size(); ++p) {
            const Node& node = file.nodes()[i].node;
            const auto values = file.plane(i, p);
            ASSERT_TRUE(values) << values.error().message;
            ASSERT_EQ(*values, test::madeUpCompanion(i, node.sampleCount, file.planes()[p])) << "node " << i;
            inner += !node.isLeaf() && !values->empty();
        }
    EXPECT_EQ(inner > 0, !file.facts().companions.empty());
}

// Right because every node, sample, value and fact is compared with what went in, bit by bit.
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
        EXPECT_EQ((*file)->planes().size(), columns ? 5u : 0u);
        expectSameNodes(**file, cloud->octree);
        expectSameColumns(**file);
        expectSameCompanions(**file);
        test::expectSameFacts((*file)->facts(), facts);
        for (std::size_t i = 0; i < facts.photos.size(); ++i)
            EXPECT_EQ((*file)->facts().photos[i].data->read().value(), facts.photos[i].data->read().value());
        EXPECT_FALSE(std::filesystem::exists(path.string() + ".partial"));
    }
}

// What is served stays readable when its cloud has gone, and whatever happened to the file since is told.
TEST(CloudFile, PhotosOutliveItAndDamageIsNamed) {
    auto bytes = test::sampleFile();
    auto file = test::openBytes(bytes).value();
    const Photo photo = file->facts().photos.at(1);
    const std::uint64_t at = file->photoPlaces()[1].offset;
    file.reset();
    const auto read = photo.data->read();
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(read->data()), read->size()), "the second's");
    bytes[at + 3] ^= std::byte(1);
    const auto damaged = photo.data->read();
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().code, ErrorCode::Malformed);
    EXPECT_EQ(damaged.error().message, "memory.scan, photo 1 at byte " + std::to_string(at) +
                                           ": its checksum is wrong; it is damaged");
}

TEST(CloudFile, ConfidenceIsKept) {
    const auto bytes = test::forged(test::sampleFile(), [](test::FileParts& file) {
        for (std::size_t i = 0; i < file.nodes.size(); ++i)
            file.nodes[i].node.confidence = std::uint8_t(7 * i);
    });
    const auto file = test::openBytes(bytes).value();
    for (std::size_t i = 0; i < file->nodes().size(); ++i)
        EXPECT_EQ(file->nodes()[i].node.confidence, std::uint8_t(7 * i));
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
    EXPECT_EQ(file->plane(std::uint32_t(file->nodes().size()), 0).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(file->plane(0, file->planes().size()).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(file->rows(std::uint32_t(file->nodes().size())).error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace scancast
