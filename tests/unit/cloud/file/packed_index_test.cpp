// Indices come back to the last bit, whatever is in them; and what is stored bounds what they may claim to hold.
#include "renderer/cloud/file/packed_index.hpp"

#include <gtest/gtest.h>

#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "tests/support/clouds/version_two.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

/// Bytes of which every third is noise, so that there are planes of all kinds.
std::vector<std::byte> someRecords(std::size_t count, const PackedLayout& layout) {
    std::vector<std::byte> records(count * layout.recordBytes);
    for (std::size_t i = 0; i < records.size(); ++i) {
        const std::size_t at = i % layout.recordBytes;
        records[i] =
            at % 3 == 0 ? std::byte(256 * test::uniform(i, 1)) : std::byte(at % 3 == 1 ? 7 : i / 5000);
    }
    return records;
}

Expected<std::vector<std::byte>> unpack(std::span<const std::byte> stored, std::size_t count,
                                        const PackedLayout& layout) {
    RecordUnpacker unpacker(layout, count);
    std::vector<std::byte> out;
    while (unpacker.left() > 0) {
        const auto chunk = unpacker.next(stored);
        if (!chunk) return passOn(chunk);
        out.insert(out.end(), chunk->begin(), chunk->end());
    }
    if (!stored.empty() && unpacker.next(stored)) return fail(ErrorCode::Internal, "more came than there is");
    if (!stored.empty()) return fail(ErrorCode::Malformed, "something is left");
    return out;
}

TEST(PackedIndex, AnyRecordsComeBack) {
    for (const PackedLayout& layout : {packedNodes, packedPlaces})
        for (const std::size_t count : {0, 1, 2, 63, 65, 16383, 16384, 16385}) {
            const auto records = someRecords(count, layout);
            const auto stored = packRecords(records, layout);
            EXPECT_GE(stored.size(), leastPackedBytes * count);
            EXPECT_LE(stored.size(), (count / chunkRecords + 1) * layout.longestChunk());
            const auto back = unpack(stored, count, layout);
            ASSERT_TRUE(back) << count << ": " << back.error().message;
            EXPECT_EQ(*back, records) << count;
        }
}

TEST(PackedIndex, OtherLengthsAndCountsAreErrors) {
    const std::size_t count = 40;
    const auto stored = packRecords(someRecords(count, packedPlaces), packedPlaces);
    for (std::size_t length = 0; length < stored.size(); ++length)
        EXPECT_FALSE(unpack(std::span(stored).first(length), count, packedPlaces)) << length;
    auto longer = stored;
    longer.push_back(std::byte(0));
    EXPECT_FALSE(unpack(longer, count, packedPlaces));
    for (const std::size_t other : {0, 1, 39, 41, 100000})
        EXPECT_FALSE(unpack(stored, other, packedPlaces)) << other;
}

TEST(PackedIndex, ResidualsOfASoundIndexAreZeroWhereAllIsKnown) {
    const auto parts = test::partsOf(test::sampleFile());
    const auto residuals = residualsOf(parts.nodes);
    for (std::size_t i = 0; i < parts.nodes.size(); ++i)
        for (const FileField& field : nodeRecordFields) {
            if (field.name != "center" && field.name != "firstSample" && field.name != "firstChild" &&
                (field.name != "points" || !parts.nodes[i].node.isLeaf()))
                continue;
            const auto bytes = std::span(residuals).subspan(i * nodeRecordBytes + field.offset, field.bytes);
            EXPECT_TRUE(std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte(0); }))
                << "node " << i << ", " << field.name;
        }
}

/// A tree that is full down to this level, one sample in each leaf; all nodes have the block of the file's root.
test::FileParts fullTree(const test::FileParts& from, int levels) {
    test::FileParts parts = from;
    parts.nodes.clear();
    Node node = from.nodes[0].node;
    std::uint32_t first = 0, count = 1;
    for (int level = 0; level < levels; ++level, first += count, count *= 8)
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t index = first + i;
            const bool isLeaf = level + 1 == levels;
            node.level = std::uint8_t(level);
            node.parent = level == 0 ? noNode : (index - 1) / 8;
            node.firstChild = isLeaf ? noNode : 8 * index + 1;
            node.childCount = isLeaf ? 0 : 8;
            node.sampleCount = 1;
            node.firstSample = index;
            node.points = std::uint64_t(1) << (3 * (levels - 1 - level));
            auto place = from.nodes[0].samples;
            place.checksum = std::uint64_t(1e18 * test::uniform(index, 5));
            parts.nodes.push_back({node, place});
        }
    parts.facts.points = parts.nodes[0].node.points;
    parts.facts.columns.clear();
    parts.planes.clear();
    for (std::size_t i = 0; i < parts.nodes.size() * parts.facts.companions.size(); ++i)
        parts.planes.push_back(i % 3 == 0 ? BlockPlace{}
                                          : BlockPlace{cloudHeaderBytes + i % 11, std::uint32_t(1 + i % 5),
                                                       std::uint64_t(1e18 * test::uniform(i, 6))});
    return parts;
}

// More than one chunk of nodes, and an index of planes that is longer than what is read of it at once.
TEST(PackedIndex, ALargeOneIsReadInPieces) {
    const auto honest = test::sampleFile();
    test::FileParts large;
    const auto bytes =
        test::forged(honest, [&](test::FileParts& parts) { large = parts = fullTree(parts, 6); });
    const auto header = parseHeader(std::span(bytes).first(cloudHeaderBytes), bytes.size()).value();
    ASSERT_GT(header.nodes, 2 * chunkRecords);
    ASSERT_GT(header.planes.bytes, packedPlaces.longestChunk());
    const auto file = test::openBytes(bytes);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(test::nodeRecords((*file)->nodes()), test::nodeRecords(large.nodes));
    EXPECT_EQ(test::planePlaces(**file), large.planes);
    for (const std::uint64_t at :
         {header.index.offset + header.index.bytes / 2, header.planes.end() - 1000}) {
        auto damaged = bytes;
        damaged[at] ^= std::byte(16);
        const auto refused = test::openBytes(damaged);
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("its checksum is wrong"), std::string::npos)
            << refused.error().message;
    }
}

// Whoever lies about a length gets no memory for it: each record has eight bytes at least.
TEST(PackedIndex, ShortIndicesClaimNoManyRecords) {
    const auto honest = test::sampleFile();
    const auto blocks = std::span(honest).first(1000);
    const auto parts = test::partsOf(honest);
    const auto nodes = packRecords(residualsOf(parts.nodes), packedNodes);
    const auto text = [](const CloudFacts& facts, std::span<const BlockPlace> photos) {
        return printFacts(facts, "forger", photos).value();
    };
    CloudFileHeader header;
    header.nodes = std::uint32_t(nodes.size() / leastPackedBytes + 1);
    auto facts = text(parts.facts, parts.photos);
    auto file = test::openBytes(test::assembled(blocks, header, nodes, std::vector<std::byte>(1000),
                                                std::as_bytes(std::span(facts))));
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("header contradicts itself"), std::string::npos)
        << file.error().message;

    CloudFacts many = parts.facts;
    many.companions.clear();
    for (int i = 0; i < 60; ++i)
        many.companions.push_back({"p" + std::to_string(i), ColumnType::Uint8, ValuePlane::Of::Samples});
    facts = text(many, parts.photos);
    header.nodes = std::uint32_t(parts.nodes.size());
    const std::size_t planes = header.nodes * planesOf(many).size() * leastPackedBytes;
    file = test::openBytes(test::assembled(blocks, header, nodes, std::vector<std::byte>(planes - 1),
                                           std::as_bytes(std::span(facts))));
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("too few for"), std::string::npos) << file.error().message;
}

}  // namespace
}  // namespace scancast
