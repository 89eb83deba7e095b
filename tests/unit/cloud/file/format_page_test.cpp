// CLOUD_FILE.md is what others read; these tests fail when it and the code part ways.
#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "files/bytes.hpp"
#include "protocol/json_text.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "tests/support/clouds/version_two.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

std::string page() {
    std::ifstream file(SCANCAST_SOURCE_DIR "/renderer/cloud/file/CLOUD_FILE.md");
    EXPECT_TRUE(file) << "CLOUD_FILE.md is not there";
    return {std::istreambuf_iterator<char>(file), {}};
}

template <std::size_t N>
void expectRows(const std::array<FileField, N>& fields, std::size_t total) {
    const auto text = page();
    std::size_t next = 0;
    for (const FileField& field : fields) {
        const auto row = "| " + std::to_string(field.offset) + " | " + std::to_string(field.bytes) + " | `" +
                         std::string(field.name) + "` | ";
        EXPECT_NE(text.find(row), std::string::npos) << row;
        EXPECT_EQ(field.offset, next) << "fields leave no gap";
        next += field.bytes;
    }
    EXPECT_EQ(next, total);
}

TEST(FormatPage, HasEveryFieldWithItsPlace) {
    expectRows(cloudHeaderFields, cloudHeaderBytes);
    expectRows(nodeRecordFields, nodeRecordBytes);
    expectRows(planeRecordFields, planeRecordBytes);
}

// As decodeRowsPlace() takes them.
TEST(FormatPage, HasTheRowsOfVersionOne) {
    const auto text = page();
    const auto old = text.find("## Version 1");
    ASSERT_NE(old, std::string::npos);
    std::array<std::byte, nodeRecordBytes> record{};
    storeLe(&record[184], std::uint64_t(1) << 40);
    storeLe(&record[192], ~std::uint64_t(0));
    storeLe(&record[200], std::uint32_t(7));
    EXPECT_EQ(decodeRowsPlace(record), (BlockPlace{std::uint64_t(1) << 40, 7, ~std::uint64_t(0)}));
    for (const char* row :
         {"| 184 | 8 | `rowsOffset` | ", "| 192 | 8 | `rowsChecksum` | ", "| 200 | 4 | `rowsBytes` | "})
        EXPECT_NE(text.find(row, old), std::string::npos) << row;
}

/// The bytes of a field in a record.
template <std::size_t N>
std::vector<std::byte> bytesAt(const std::array<FileField, N>& fields, std::string_view name,
                               std::span<const std::byte> record) {
    for (const FileField& field : fields)
        if (field.name == name) {
            const auto bytes = record.subspan(field.offset, field.bytes);
            return {bytes.begin(), bytes.end()};
        }
    ADD_FAILURE() << name;
    return {};
}

template <class T>
std::vector<std::byte> bytesOfValue(const T& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    return {bytes.begin(), bytes.end()};
}

/// Up to 16384 packed records: checksums, then the other bytes in byte planes, as values have them.
std::vector<std::byte> chunkByThePage(std::span<const std::byte> stored, std::size_t records,
                                      std::size_t recordBytes, std::size_t checksumAt) {
    const auto rest = decodeRows(stored.subspan(8 * records), recordBytes - 8, records).value();
    std::vector<std::byte> out;
    for (std::size_t i = 0; i < records; ++i) {
        const auto others = std::span(rest).subspan(i * (recordBytes - 8), recordBytes - 8);
        const auto before = others.first(checksumAt), checksum = stored.subspan(8 * i, 8),
                   behind = others.subspan(checksumAt);
        for (const auto part : {before, checksum, behind}) out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

/// A number of some record, to read and to XOR.
struct Number {
    std::byte* at;
    std::size_t bytes;
    std::uint64_t value() const {
        std::uint64_t v = 0;
        std::memcpy(&v, at, bytes);
        return v;
    }
    double asDouble() const { return loadLe<double>(at); }
    void take(std::uint64_t expected) const {
        const std::uint64_t v = value() ^ expected;
        std::memcpy(at, &v, bytes);
    }
};

/// "Packed indices" of nodes, as somebody would write it who has the page alone.
std::vector<std::byte> nodesByThePage(std::span<const std::byte> stored, std::size_t count) {
    auto records = chunkByThePage(stored, count, 208, 176);
    const auto number = [&](std::size_t node, std::size_t at, std::size_t bytes = 8) {
        return Number{&records[208 * node + at], bytes};
    };
    std::uint32_t children = 1;
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0) {
            number(i, 132, 4).take(number(i - 1, 132, 4).value());
            number(i, 152).take(number(i - 1, 152).value() + number(i - 1, 144, 4).value());
            number(i, 168).take(number(i - 1, 168).value() + number(i - 1, 148, 4).value());
            const std::size_t parent = number(i, 132, 4).value();
            for (const std::size_t at : {0, 8, 16, 48, 56, 64})
                number(i, at).take(number(parent, at).value());
        }
        for (const std::size_t at : {0, 8, 16}) {
            const double middle = (number(i, at).asDouble() + number(i, 48 + at).asDouble()) * 0.5;
            number(i, 72 + at).take(std::bit_cast<std::uint64_t>(middle));
        }
        number(i, 112, 4).take(number(i, 104, 4).value());
        number(i, 160).take(number(i, 144, 4).value());
        const std::uint64_t own = number(i, 140, 1).value();
        number(i, 136, 4).take(own > 0 ? children : 0xffffffffu);
        children += std::uint32_t(own);
    }
    return records;
}

/// The same for planes.
std::vector<std::byte> planesByThePage(std::span<const std::byte> stored, std::span<const std::byte> nodes,
                                       std::size_t planes) {
    auto records = chunkByThePage(stored, nodes.size() / 208 * planes, 24, 8);
    std::uint64_t end = 0;
    for (std::size_t i = 0; i < records.size() / 24; ++i) {
        const Number offset{&records[24 * i], 8}, bytes{&records[24 * i + 16], 4};
        const std::byte* node = &nodes[i / planes * 208];
        if (i % planes == 0) end = loadLe<std::uint64_t>(node + 168) + loadLe<std::uint32_t>(node + 148);
        if (bytes.value() == 0) continue;
        offset.take(end);
        end = offset.value() + bytes.value();
    }
    return records;
}

TEST(FormatPage, SaysHowIndicesArePacked) {
    const auto bytes = test::sampleFile();
    const auto file = test::openBytes(bytes).value();
    const auto parsed = parseHeader(std::span(bytes).first(cloudHeaderBytes), bytes.size()).value();
    const auto records = nodesByThePage(std::span(bytes).subspan(parsed.index.offset, parsed.index.bytes),
                                        file->nodes().size());
    EXPECT_EQ(records, test::nodeRecords(file->nodes()));
    EXPECT_EQ(
        planesByThePage(std::span(bytes).subspan(parsed.planes.offset, parsed.planes.bytes), records, 5),
        test::planeRecords(test::planePlaces(*file)));
    const auto text = page();
    const auto packed = text.find("## Packed indices"), end = text.find("\n## ", packed);
    ASSERT_NE(packed, std::string::npos);
    for (const char* field : {"parent", "firstSample", "samplesOffset", "boxMin", "boxMax", "center",
                              "radiusUnit", "points", "firstChild", "offset"})
        EXPECT_LT(text.find("`" + std::string(field) + "`", packed), end) << field;
}

// Right because the tables say where, the test says what, and the writer knows neither.
TEST(FormatPage, TheFileHasItsFieldsThere) {
    const auto bytes = test::sampleFile();
    const auto file = test::openBytes(bytes).value();
    const auto start = std::span(bytes).first(cloudHeaderBytes);
    const auto header = [&](std::string_view name) { return bytesAt(cloudHeaderFields, name, start); };
    const auto parsed = parseHeader(start, bytes.size()).value();
    EXPECT_EQ(header("magic"), bytesOfValue(cloudFileMagic));
    EXPECT_EQ(header("version"), bytesOfValue(std::uint32_t(3)));
    EXPECT_EQ(header("headerBytes"), bytesOfValue(std::uint32_t(128)));
    EXPECT_EQ(header("fileBytes"), bytesOfValue(std::uint64_t(bytes.size())));
    EXPECT_EQ(header("indexOffset"), bytesOfValue(parsed.index.offset));
    EXPECT_EQ(header("indexBytes"), bytesOfValue(parsed.index.bytes));
    EXPECT_EQ(header("factsOffset"), bytesOfValue(parsed.facts.offset));
    EXPECT_EQ(header("nodes"), bytesOfValue(std::uint32_t(file->nodes().size())));
    EXPECT_EQ(header("headerChecksum"), bytesOfValue(checksumOf(start.first(120))));
    EXPECT_EQ(header("indexChecksum"),
              bytesOfValue(checksumOf(std::span(bytes).subspan(parsed.index.offset, parsed.index.bytes))));
    EXPECT_EQ(header("planesOffset"), bytesOfValue(parsed.index.end()));
    EXPECT_EQ(header("planesBytes"), bytesOfValue(parsed.facts.offset - parsed.planes.offset));
    EXPECT_EQ(header("planesChecksum"),
              bytesOfValue(checksumOf(std::span(bytes).subspan(parsed.planes.offset, parsed.planes.bytes))));
    EXPECT_EQ(header("factsChecksum"),
              bytesOfValue(checksumOf(std::span(bytes).subspan(parsed.facts.offset))));

    const auto last = file->nodes().back();
    const auto records = nodesByThePage(std::span(bytes).subspan(parsed.index.offset, parsed.index.bytes),
                                        file->nodes().size());
    const auto record = std::span(records).last(nodeRecordBytes);
    const auto node = [&](std::string_view name) { return bytesAt(nodeRecordFields, name, record); };
    EXPECT_EQ(node("boxMin"), bytesOfValue(last.node.boxMin));
    EXPECT_EQ(node("step"), bytesOfValue(last.node.step));
    EXPECT_EQ(node("boxMax"), bytesOfValue(last.node.boxMax));
    EXPECT_EQ(node("center"), bytesOfValue(last.node.center));
    EXPECT_EQ(node("radius"), bytesOfValue(last.node.radius));
    EXPECT_EQ(node("spacing"), bytesOfValue(last.node.spacing));
    EXPECT_EQ(node("meanSpacing"), bytesOfValue(last.node.meanSpacing));
    EXPECT_EQ(node("radiusUnit"), bytesOfValue(last.node.radiusUnit));
    EXPECT_EQ(node("coneAxis"), bytesOfValue(last.node.cone.axis));
    EXPECT_EQ(node("coneHalfAngle"), bytesOfValue(last.node.cone.halfAngle));
    EXPECT_EQ(node("parent"), bytesOfValue(last.node.parent));
    EXPECT_EQ(node("firstChild"), bytesOfValue(noNode));
    EXPECT_EQ(node("childCount"), bytesOfValue(last.node.childCount));
    EXPECT_EQ(node("level"), bytesOfValue(last.node.level));
    EXPECT_EQ(node("sampleCount"), bytesOfValue(last.node.sampleCount));
    EXPECT_EQ(node("firstSample"), bytesOfValue(last.node.firstSample));
    EXPECT_EQ(node("points"), bytesOfValue(last.node.points));
    EXPECT_EQ(node("samplesOffset"), bytesOfValue(last.samples.offset));
    EXPECT_EQ(node("samplesBytes"), bytesOfValue(last.samples.bytes));
    EXPECT_EQ(node("samplesChecksum"), bytesOfValue(last.samples.checksum));
    EXPECT_EQ(node("confidence"), bytesOfValue(last.node.confidence));

    const auto place = file->planePlace(std::uint32_t(file->nodes().size() - 1), 4);
    const auto beside =
        planesByThePage(std::span(bytes).subspan(parsed.planes.offset, parsed.planes.bytes), records, 5);
    const auto end = std::span(beside).last(planeRecordBytes);
    const auto plane = [&](std::string_view name) { return bytesAt(planeRecordFields, name, end); };
    EXPECT_EQ(plane("offset"), bytesOfValue(place.offset));
    EXPECT_EQ(plane("bytes"), bytesOfValue(place.bytes));
    EXPECT_EQ(plane("checksum"), bytesOfValue(place.checksum));
}

TEST(FormatPage, NamesEveryFact) {
    const auto text = page();
    const auto json = parseJson(printFacts(test::fullFacts(CloudFacts{}, true), "me",
                                           std::vector<BlockPlace>(2, {128, 1, 0}))
                                    .value())
                          .value();
    for (const auto& [key, value] : json.items())
        EXPECT_NE(text.find("`" + key + "`"), std::string::npos) << key;
    EXPECT_NE(text.find(std::to_string(chunkRecords)), std::string::npos) << "the samples of a chunk";
}

}  // namespace
}  // namespace scancast
