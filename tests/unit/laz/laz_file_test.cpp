// Files of every way to cut points into chunks, made by an encoder of the tests' own, and real ones whose uncompressed twins are there.
#include "importers/laz/decoder/laz_file.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/sized.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/laz/laz_bytes.hpp"

namespace scancast::laz {

namespace {

using test::Bytes;
using test::LazPlan;

Expected<LazFile> openBytes(const Bytes& bytes) {
    return LazFile::open(std::make_shared<MemoryAccess>(bytes));
}

/// All records, `points` at a time.
Expected<Bytes> decodeAll(const LazFile& file, std::size_t points) {
    LazDecoder decoder(file);
    Bytes records;
    for (const Chunk& chunk : file.chunks()) {
        if (auto ok = decoder.start(chunk); !ok) return passOn(ok);
        while (decoder.left() > 0) {
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points, decoder.left()));
            const std::size_t at = records.size();
            records.resize(at + count * file.shape().recordBytes);
            if (auto ok = decoder.read(std::span(records).subspan(at)); !ok) return passOn(ok);
        }
    }
    return records;
}

Bytes fileBytes(const char* name) {
    const auto file = InputFile::open(test::testData(name)).value();
    Bytes bytes(file.bytes());
    EXPECT_EQ(file.readAt(0, bytes).value(), bytes.size());
    return bytes;
}

const LazPlan plans[] = {
    {.compressor = 1, .chunkPoints = 0, .chunks = {120}},
    {},
    {.chunks = {50, 1}},
    {.chunkPoints = 0xffffffff, .chunks = {7, 90, 1, 0, 22}},
    {.chunkPoints = 0, .chunks = {7, 90}},
    {.tableIsWritten = false},
    {.placeIsAtEnd = true},
    {.pointFormat = 6, .compressor = 3},
    {.pointFormat = 6, .compressor = 3, .chunkPoints = 0xffffffff, .chunks = {300, 1, 2}},
    {.pointFormat = 6, .compressor = 3, .tableIsWritten = false},
    {.pointFormat = 6, .compressor = 3, .placeIsAtEnd = true},
};

}  // namespace

TEST(LazFile, GivesThePointsOfEveryWayToCutThem) {
    for (const LazPlan& plan : plans) {
        const auto made = test::makeLaz(plan);
        const auto file = openBytes(made.file);
        ASSERT_TRUE(file) << file.error().message;
        for (const std::size_t points : {1, 3, 64, 1000}) {
            const auto records = decodeAll(*file, points);
            ASSERT_TRUE(records) << records.error().message;
            EXPECT_TRUE(*records == made.records)
                << plan.pointFormat << ' ' << plan.compressor << ' ' << points;
        }
        EXPECT_EQ(file->head().size(), file->shape().pointOffset);
        EXPECT_EQ(file->head()[104], static_cast<std::byte>(plan.pointFormat));
    }
}

TEST(LazFile, ChunksStandForThemselves) {
    const auto made = test::makeLaz({});
    const auto file = openBytes(made.file).value();
    ASSERT_EQ(file.chunks().size(), 3U);
    LazDecoder decoder(file);
    for (const std::size_t i : {2, 0, 1, 1}) {
        const Chunk& chunk = file.chunks()[i];
        Bytes records(chunk.points * 20);
        ASSERT_TRUE(decoder.start(chunk));
        ASSERT_TRUE(decoder.read(records));
        EXPECT_EQ(std::memcmp(records.data(), made.records.data() + chunk.first * 20, records.size()), 0);
        Bytes again(records.size());
        ASSERT_TRUE(decodeChunk(file, chunk, again));
        EXPECT_TRUE(again == records);
    }
}

TEST(LazFile, EveryTruncationIsTold) {
    for (const LazPlan& plan : plans) {
        const auto made = test::makeLaz(plan);
        for (std::size_t bytes = 0; bytes < made.file.size(); bytes += test::sized(1, 7)) {
            const Bytes cut(made.file.begin(), made.file.begin() + static_cast<std::ptrdiff_t>(bytes));
            const auto file = openBytes(cut);
            const auto records =
                file ? decodeAll(*file, 1000) : Expected<Bytes>(tl::unexpected(file.error()));
            if (records) {
                // Only a chunk table may lack its last bytes, which its decoder reads ahead.
                ASSERT_GE(bytes + 8, made.file.size());
                ASSERT_TRUE(*records == made.records);
            } else {
                ASSERT_GT(records.error().message.size(), 10U);
            }
        }
    }
}

/// Of a file that was cut, the points before the cut.
TEST(LazFile, WhatIsWholeIsKept) {
    for (const LazPlan& plan : plans) {
        const auto made = test::makeLaz(plan);
        std::uint64_t before = 0;
        for (std::size_t bytes = 600; bytes < made.file.size(); bytes += test::sized(9, 60)) {
            const Bytes cut(made.file.begin(), made.file.begin() + static_cast<std::ptrdiff_t>(bytes));
            auto file = LazFile::open(std::make_shared<MemoryAccess>(cut), true);
            if (!file) continue;
            const auto whole = file->keepWhole();
            if (!whole) continue;
            ASSERT_GE(*whole, before);
            before = *whole;
            const auto records = decodeAll(*file, 1000);
            ASSERT_TRUE(records) << records.error().message;
            ASSERT_EQ(records->size(), *whole * file->shape().recordBytes);
            ASSERT_TRUE(std::equal(records->begin(), records->end(), made.records.begin()));
        }
        // Only a table says how many points chunks of several sizes have.
        const bool isVariable =
            plan.compressor != 1 && (plan.chunkPoints == 0 || plan.chunkPoints == 0xffffffff);
        if (!isVariable) {
            EXPECT_GT(before, 0U);
        }
    }
}

TEST(LazFile, LiesEndInASentence) {
    std::mt19937 random(3);
    int refused = 0, tries = 0;
    for (const LazPlan& plan : plans) {
        const auto made = test::makeLaz(plan);
        for (int i = 0; i < test::sized(300, 40); ++i, ++tries) {
            Bytes lying = made.file;
            for (auto count = 1 + random() % 3; count > 0; --count) {
                const std::size_t at = random() % 2 == 0
                                           ? random() % lying.size()
                                           : 94 + random() % std::min<std::size_t>(lying.size() - 94, 400);
                lying[at] = static_cast<std::byte>(random() % 3 == 0 ? 0xff : random());
            }
            const auto file = openBytes(lying);
            if (!file) {
                ++refused;
                EXPECT_GT(file.error().message.size(), 10U);
                continue;
            }
            if (file->shape().points > 100'000) continue;
            const auto records = decodeAll(*file, 500);
            if (!records) ++refused;
            if (records) {
                EXPECT_EQ(records->size(), file->shape().points * file->shape().recordBytes);
            }
        }
    }
    EXPECT_GT(refused, tries / 10);
}

TEST(LazFile, SaysWhatIsWrong) {
    const auto made = test::makeLaz({.pointFormat = 6, .compressor = 3});
    const std::size_t offset = 375 + 94;
    const auto table = loadLe<std::uint64_t>(made.file.data() + offset);
    const auto expectReason = [&](const std::function<void(Bytes&)>& lie, const std::string& reason) {
        Bytes lying = made.file;
        lie(lying);
        const auto file = openBytes(lying);
        const auto records = file ? decodeAll(*file, 1000) : Expected<Bytes>(tl::unexpected(file.error()));
        ASSERT_FALSE(records) << reason;
        EXPECT_NE(records.error().message.find(reason), std::string::npos) << records.error().message;
    };
    using test::put;
    expectReason([](Bytes& b) { b[0] = std::byte{'X'}; }, "does not start with \"LASF\"");
    expectReason([](Bytes& b) { put<std::uint64_t>(b, 247, 999); },
                 "has 3 chunks of 50 points; the header promises 999 points");
    expectReason([](Bytes& b) { put<std::uint64_t>(b, 247, 0), put<std::uint32_t>(b, 107, 0); },
                 "without points");
    expectReason([&](Bytes& b) { put<std::uint32_t>(b, table + 4, 0xffffffff); },
                 "the chunk table promises 4,294,967,295 chunks");
    expectReason([&](Bytes& b) { put<std::uint32_t>(b, table, 7); }, "the chunk table has version 7");
    expectReason([&](Bytes& b) { put<std::int64_t>(b, offset, -5); },
                 "place of the chunk table is wrong (-5)");
    expectReason([&](Bytes& b) { put<std::int64_t>(b, offset, std::int64_t(1) << 40); },
                 "is said to start at byte 1,099,511,627,776");
    expectReason([&](Bytes& b) { put<std::uint32_t>(b, offset + 8 + 30, 51); }, "says that it has 51 points");
    expectReason([&](Bytes& b) { put<std::uint32_t>(b, offset + 8 + 38, 1 << 30); },
                 "its layers would end after");
    expectReason([](Bytes& b) { b[104] = std::byte{0x89}; },
                 "a point record has 30 bytes; point format 9 needs 59");
    expectReason([](Bytes& b) { put<std::uint16_t>(b, 375 + 54, 4); }, "LAZ compressor 4 is not known");
    expectReason([](Bytes& b) { put<std::uint16_t>(b, 375 + 56, 1); }, "LAZ coder 1 is not known");
    expectReason([](Bytes& b) { put<std::uint16_t>(b, 375 + 92, 5); },
                 "POINT14 version 5; versions 3 and 4 can");
    expectReason([](Bytes& b) { put<std::uint16_t>(b, 375 + 88, 6); },
                 "(POINT10 version 3) does not describe the records of 30 bytes");
}

TEST(LazFile, IsItsUncompressedTwin) {
    int compared = 0;
    for (const auto& [laz, las] : {std::pair("laz/autzen_trim.laz", "las/autzen_trim.las"),
                                   {"laz/pdrf2-color.laz", "las/las12-pdrf2-color.las"},
                                   {"laz/pdrf0-compressor1-pointwise.laz", "las/las10-pdrf0.las"},
                                   {"laz/pdrf5-1.3.laz", "las/pdrf5-1.3.las"},
                                   {"laz/pdrf8-1.4.laz", "las/pdrf8-1.4.las"},
                                   {"laz/pdrf9-1.4.laz", "las/pdrf9-1.4.las"}}) {
        if (!std::filesystem::exists(test::testData(laz))) continue;
        const Bytes compressed = fileBytes(laz), plain = fileBytes(las);
        const auto file = openBytes(compressed);
        ASSERT_TRUE(file) << laz << ' ' << file.error().message;
        const auto twin = openBytes(plain).value();
        const auto records = decodeAll(*file, 1000);
        ASSERT_TRUE(records) << laz << ' ' << records.error().message;
        EXPECT_TRUE(*records == decodeAll(twin, 999).value()) << laz;
        ++compared;
    }
    if (compared == 0) GTEST_SKIP() << "MISSING TEST DATA: laz, las";
}

/// Points 1,024 of waveforms, of which another file has the same with colours.
TEST(LazFile, WaveformsAreThoseOfTheFileWithColors) {
    REQUIRE_TEST_DATA("laz/pdrf4-1.3.laz");
    const Bytes without = fileBytes("laz/pdrf4-1.3.laz"), with = fileBytes("laz/pdrf5-1.3.laz");
    const Bytes a = decodeAll(openBytes(without).value(), 100).value(),
                b = decodeAll(openBytes(with).value(), 100).value();
    ASSERT_EQ(a.size(), 1024U * 61);
    ASSERT_EQ(b.size(), 1024U * 67);
    for (std::size_t i = 0; i < 1024; ++i) {
        ASSERT_EQ(std::memcmp(a.data() + 61 * i, b.data() + 67 * i, 28), 0) << i;
        ASSERT_EQ(std::memcmp(a.data() + 61 * i + 28, b.data() + 67 * i + 34, 29), 0) << i;
    }
}

/// What only colours are wanted of has the same colours.
TEST(LazFile, ColorsAloneAreTheSame) {
    for (const auto* const name :
         {"laz/pdrf8-1.4.laz", "laz/pdrf7-v4-1.4.laz", "copc/lion_takanawa.copc.laz"}) {
        REQUIRE_TEST_DATA(name);
        const Bytes bytes = fileBytes(name);
        const auto file = openBytes(bytes).value();
        LazDecoder all(file), colors(file, Wanted::Colors);
        const std::size_t record = file.shape().recordBytes;
        for (const Chunk& chunk : file.chunks()) {
            Bytes a(chunk.points * record), b(a.size());
            ASSERT_TRUE(all.start(chunk) && all.read(a) && colors.start(chunk) && colors.read(b)) << name;
            for (std::size_t at = 30; at < a.size(); at += record)
                ASSERT_EQ(std::memcmp(a.data() + at, b.data() + at, 6), 0) << name;
        }
    }
}

}  // namespace scancast::laz
