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

PointBatch readWhole(PointSource& source) {
    PointBatch all, batch;
    while (source.read(batch).value()) {
        all.position.insert(all.position.end(), batch.position.begin(), batch.position.end());
        all.color.insert(all.color.end(), batch.color.begin(), batch.color.end());
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
    auto reader =
        PointStreamReader::create(std::make_unique<MemoryByteSource>(stream, false), 1'000'000, true);
    ASSERT_TRUE(reader) << reader.error().message;
    Bytes plain(made.file.begin(), made.file.begin() + 375 + 94);
    plain[104] = std::byte{6};
    test::append(plain, made.records);
    auto source = LasSource::create(std::make_unique<MemoryByteSource>(plain), "plain.las", true);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ((*reader)->header().format, "LAZ 1.4, point format 6");
    EXPECT_EQ((*reader)->header().points, (*source)->header().points);
    EXPECT_EQ((*reader)->header().columns, (*source)->header().columns);
    PointBatch batch;
    PointBatch fromStream;
    for (;;) {
        const auto more = (*reader)->read(batch);
        ASSERT_TRUE(more) << more.error().message;
        if (!*more) break;
        fromStream.position.insert(fromStream.position.end(), batch.position.begin(), batch.position.end());
        fromStream.rows.insert(fromStream.rows.end(), batch.rows.begin(), batch.rows.end());
    }
    const PointBatch fromFile = readWhole(**source);
    EXPECT_TRUE(fromStream.position == fromFile.position);
    EXPECT_TRUE(fromStream.rows == fromFile.rows);
    EXPECT_EQ(fromFile.position.size(), 120U);
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
