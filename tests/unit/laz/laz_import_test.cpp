// What the importer writes does not depend on threads, nor on how much it may keep; and it reads as the uncompressed file does.
#include "importers/laz/laz_import.hpp"

#include <gtest/gtest.h>

#include "renderer/cloud/import/las/las_source.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/laz/laz_bytes.hpp"

namespace scancast {

namespace {

using test::Bytes;

Bytes streamOf(const Bytes& file, const import_laz::ImportLimits& limits) {
    Bytes stream;
    PointStreamWriter writer([&](std::span<const std::byte> bytes) {
        stream.insert(stream.end(), bytes.begin(), bytes.end());
        return true;
    });
    const auto done = import_laz::importLaz(std::make_shared<laz::MemoryAccess>(file), limits, writer);
    EXPECT_TRUE(done) << done.error().message;
    return stream;
}

struct Read {
    std::vector<glm::dvec3> positions;
    std::vector<std::byte> rows;
};

Read readWhole(PointSource& source) {
    Read all;
    PointBatch batch;
    while (source.read(batch).value()) {
        for (std::size_t i = 0; i < batch.size(); ++i) all.positions.push_back(batch.position[i]);
        all.rows.insert(all.rows.end(), batch.rows.begin(), batch.rows.end());
    }
    return all;
}

}  // namespace

TEST(LazImport, IsTheSameHoweverItIsDone) {
    std::vector<Bytes> files{test::makeLaz({}).file, test::makeLaz({.pointFormat = 6, .compressor = 3}).file};
    if (std::filesystem::exists(test::testData("laz/autzen_trim.laz"))) {
        const auto real = InputFile::open(test::testData("laz/autzen_trim.laz")).value();
        Bytes bytes(real.bytes());
        ASSERT_TRUE(real.readAt(0, bytes));
        files.push_back(std::move(bytes));
    }
    for (const Bytes& file : files) {
        const Bytes stream = streamOf(file, {.threads = 1, .kept = 0, .fewestToGlanceAt = 100});
        for (const std::size_t kept : {std::size_t(2'000'000), std::size_t(1) << 30})
            EXPECT_TRUE(streamOf(file, {.threads = 3, .kept = kept, .fewestToGlanceAt = 100}) == stream);
    }
}

TEST(LazImport, ReadsAsTheUncompressedFileDoes) {
    const auto made = test::makeLaz({.pointFormat = 6, .compressor = 3});
    const Bytes stream = streamOf(made.file, {.threads = 2, .piece = 700});
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(stream, false),
                                            {.mostPoints = 1'000'000, .keepAttributes = true});
    ASSERT_TRUE(reader) << reader.error().message;
    Bytes plain(made.file.begin(), made.file.begin() + 375 + 94);
    plain[104] = std::byte{6};
    test::append(plain, made.records);
    auto source = LasSource::create(std::make_unique<MemoryByteSource>(plain), "plain.las", true);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ((*reader)->header().format, "LAZ 1.4, point format 6");
    EXPECT_EQ((*reader)->header().points, (*source)->header().points);
    EXPECT_EQ((*reader)->header().columns, (*source)->header().columns);
    const Read fromStream = readWhole(**reader), fromFile = readWhole(**source);
    EXPECT_EQ(fromStream.positions, fromFile.positions);
    EXPECT_TRUE(fromStream.rows == fromFile.rows);
    EXPECT_EQ(fromFile.positions.size(), 120U);
}

/// A file without its end says how much of it is there.
TEST(LazImport, RecoversWhatIsWhole) {
    const auto made = test::makeLaz({.pointFormat = 6, .compressor = 3});
    // Into the third chunk of 50, 50, 20.
    const auto table = loadLe<std::uint64_t>(made.file.data() + 375 + 94);
    const Bytes cut(made.file.begin(), made.file.begin() + static_cast<std::ptrdiff_t>(table) - 5);
    const Bytes stream = streamOf(cut, {.recover = true});
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(stream, false),
                                            {.mostPoints = 1'000'000});
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->header().points, std::nullopt);
    EXPECT_EQ(readWhole(**reader).positions.size(), 100U);
    ASSERT_EQ((*reader)->notes().size(), 1U);
    EXPECT_EQ((*reader)->notes()[0],
              "it ends too early: of the 120 points that it promises, 100 are whole and were read; 20 (16.7 "
              "%) are lost");
    // A sound one is what it always is.
    EXPECT_TRUE(streamOf(made.file, {.recover = true}) == streamOf(made.file, {}));
}

TEST(LazImport, RefusesWhatIsNotCompressed) {
    const auto made = test::makeLaz({});
    Bytes plain(made.file.begin(), made.file.begin() + 227 + 94);
    plain[104] = std::byte{0};
    test::append(plain, made.records);
    PointStreamWriter writer([](std::span<const std::byte>) { return true; });
    const auto done = import_laz::importLaz(std::make_shared<laz::MemoryAccess>(plain), {}, writer);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::Unsupported);
}

}  // namespace scancast
