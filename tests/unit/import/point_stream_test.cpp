// The point stream: what is written is what is read, and a stream that lies is an error.
#include <gmock/gmock.h>

#include <limits>

#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "tests/unit/import/las_bytes.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

using Bytes = std::vector<std::byte>;

/// A stream into memory.
struct Recorder {
    Bytes bytes;
    PointStreamWriter writer{[this](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }};
};

PointBatch batchOf(std::size_t n, const Attributes& has, int seed = 0) {
    PointBatch batch;
    for (std::size_t i = 0; i < n; ++i) {
        const auto k = static_cast<double>(i) + seed;
        batch.position.emplace_back(k + 0.1, -k, 1e7 + k / 3);
        if (has.color) batch.color.push_back({static_cast<std::uint8_t>(i), 7, 9});
        if (has.intensity) batch.intensity.push_back(static_cast<std::uint16_t>(i * 3));
        if (has.classification) batch.classification.push_back(static_cast<std::uint8_t>(i % 19));
        if (has.normal) batch.normal.emplace_back(0.0F, i % 2 == 0 ? 1.0F : 0.0F, 0.0F);
    }
    return batch;
}

ScanHeader headerOf(const Attributes& has, std::optional<std::uint64_t> points = {}) {
    ScanHeader header;
    header.format = "TEST 1";
    header.points = points;
    header.attributes = has;
    return header;
}

constexpr Attributes all{true, true, true, true};

/// A sound stream of two points with every column.
Bytes small(std::optional<std::uint64_t> declared = 2) {
    Recorder recorder;
    EXPECT_TRUE(recorder.writer.writeHeader(headerOf(all, declared)));
    EXPECT_TRUE(recorder.writer.writeChunk(batchOf(2, all)));
    EXPECT_TRUE(recorder.writer.finish(0));
    return recorder.bytes;
}

constexpr std::size_t chunkAt = 136 + 6;  // header, "TEST 1"
constexpr std::size_t doneAt = chunkAt + 8 + 2 * (24 + 3 + 2 + 1 + 12);

Expected<ScanSummary> readStream(const Bytes& bytes,
                                 std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
    return summarizeOpened(
        PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false), {.mostPoints = most}));
}

void expectImporterError(const Bytes& bytes, const char* reason) {
    const auto scan = readStream(bytes);
    ASSERT_FALSE(scan) << reason;
    EXPECT_EQ(scan.error().code, ErrorCode::Importer) << scan.error().message;
    EXPECT_THAT(scan.error().message, HasSubstr(reason));
}

template <class T>
Bytes changed(std::size_t at, T value) {
    auto bytes = small();
    put(bytes, at, value);
    return bytes;
}

}  // namespace

// Every combination of columns, over chunk borders: the reader must give the writer's batches back, bit by
// bit.
TEST(PointStream, RoundTrip) {
    for (int mask = 0; mask < 16; ++mask) {
        const Attributes has{(mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0, (mask & 8) != 0};
        auto header =
            headerOf(has, mask % 2 == 0 ? std::optional<std::uint64_t>(65536 + 100 + 7) : std::nullopt);
        header.gridStep = {0.01, 0.02, 0.03};
        header.gridOrigin = {5, 6, 7};
        header.bounds = {glm::dvec3(-1), glm::dvec3(2)};
        header.crsWkt = "PROJCS[]";
        header.crsEpsg = 25832;
        if (mask > 7) header.scannerOrigin = {1e6, -2, 0.1};
        const std::vector<PointBatch> batches{batchOf(65536, has), batchOf(100, has, 5)};
        Recorder recorder;
        ASSERT_TRUE(recorder.writer.writeHeader(header));
        for (const auto& batch : batches) ASSERT_TRUE(recorder.writer.writeChunk(batch));
        ASSERT_TRUE(recorder.writer.finish(7));

        const auto reader =
            PointStreamReader::create(std::make_unique<MemoryByteSource>(recorder.bytes, false));
        ASSERT_TRUE(reader) << reader.error().message;
        const auto& read = (*reader)->header();
        EXPECT_EQ(read.format, header.format);
        EXPECT_EQ(read.points, header.points);
        EXPECT_EQ(read.attributes, has);
        EXPECT_EQ(read.gridStep, header.gridStep);
        EXPECT_EQ(read.gridOrigin, header.gridOrigin);
        EXPECT_EQ(read.bounds, header.bounds);
        EXPECT_EQ(read.crsWkt, header.crsWkt);
        EXPECT_EQ(read.crsEpsg, header.crsEpsg);
        EXPECT_EQ(read.scannerOrigin, header.scannerOrigin);
        PointBatch batch;
        for (const auto& expected : batches) {
            const auto more = (*reader)->read(batch);
            ASSERT_TRUE(more && *more);
            EXPECT_EQ(batch.position, expected.position);
            EXPECT_EQ(batch.color, expected.color);
            EXPECT_EQ(batch.intensity, expected.intensity);
            EXPECT_EQ(batch.classification, expected.classification);
            EXPECT_EQ(batch.normal, expected.normal);
        }
        const auto end = (*reader)->read(batch);
        ASSERT_TRUE(end);
        EXPECT_FALSE(*end);
        EXPECT_EQ(batch.size(), 0U);
        EXPECT_EQ((*reader)->droppedPoints(), 7U);
    }
}

// The page POINT_STREAM.md, not the code, says where things are: these offsets are copied from its tables.
TEST(PointStream, FurtherColumnsAreReadAsWritten) {
    auto header = headerOf(all, 3);
    header.columns = {{"gps_time", ColumnType::Float64, 1, 0, "seconds of the GPS week"},
                      {"amplitude \"dB\"", ColumnType::Int16, 0.01, -5, ""},
                      {"extra_0", ColumnType::Uint8, 1, 0, ""}};
    auto batch = batchOf(3, all);
    for (int i = 0; i < 3 * 11; ++i) batch.rows.push_back(static_cast<std::byte>(7 * i));
    Recorder recorder;
    ASSERT_TRUE(recorder.writer.writeHeader(header));
    ASSERT_TRUE(recorder.writer.writeChunk(batch));
    ASSERT_TRUE(recorder.writer.finish(0));
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(recorder.bytes, false));
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->header().columns, header.columns);
    PointBatch read;
    ASSERT_TRUE((*reader)->read(read).value_or(false));
    EXPECT_TRUE(read.rows == batch.rows);
    EXPECT_TRUE(read.position == batch.position);
}

TEST(PointStream, ListsOfColumnsThatLieAreErrors) {
    const auto withList = [](const std::string& list) {
        auto bytes = small();
        put(bytes, 132, static_cast<std::uint32_t>(list.size()));
        const auto* text = reinterpret_cast<const std::byte*>(list.data());
        bytes.insert(bytes.begin() + chunkAt, text, text + list.size());
        return bytes;
    };
    expectImporterError(withList("[]"), "no JSON list of 1 to 512");
    expectImporterError(withList("{}"), "no JSON list");
    expectImporterError(withList("[7]"), "column 0 is wrong: it is no JSON object");
    expectImporterError(withList(R"([{"type": "int8"}])"), "it has no name");
    expectImporterError(withList(R"([{"name": "a", "type": "int9"}])"), "type \"int9\" is not known");
    expectImporterError(withList(R"([{"name": "a", "type": "int8", "scale": 0}])"), "scale or offset");
    expectImporterError(withList(R"([{"name": "a", "type": "int8", "offset": "1"}])"), "scale or offset");
    expectImporterError(withList(R"([{"name": "a", "type": "int8"}, {"name": "a", "type": "int8"}])"),
                        "another one is called \"a\"");
    // Rows that the chunk does not have: what follows is no record.
    expectImporterError(withList(R"([{"name": "a", "type": "int8"}])"), "a record of unknown kind");
    const auto many = [] {
        std::string list = "[7";
        for (int i = 0; i < 600; ++i) list += ",7";
        return list + "]";
    };
    expectImporterError(withList(many()), "no JSON list of 1 to 512");
}

TEST(PointStream, LayoutIsAsDocumented) {
    const auto bytes = small();
    const auto text = std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_EQ(text.substr(0, 10), std::string("SCANPTS\x1a\x01\x00", 10));
    EXPECT_EQ(bytes[10], std::byte(15));
    EXPECT_EQ(bytes[12], std::byte(1));
    EXPECT_EQ(bytes[16], std::byte(2));
    EXPECT_EQ(bytes[124], std::byte(6));
    EXPECT_EQ(text.substr(136, 6), "TEST 1");
    EXPECT_EQ(text.substr(chunkAt, 5), "CHNK\x02");
    EXPECT_EQ(text.substr(doneAt, 4), "DONE");
    EXPECT_EQ(bytes[doneAt + 8], std::byte(2));
    EXPECT_EQ(bytes.size(), doneAt + 24);
}

// A missing end means that the importer died, wherever it was.
TEST(PointStream, TruncatedAtEveryByte) {
    const auto whole = small();
    ASSERT_TRUE(readStream(whole));
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        expectImporterError(cut, "broke off");
    }
}

TEST(PointStream, LiesAreErrors) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    expectImporterError(changed(0, 'X'), "does not start as a point stream does");
    expectImporterError(changed(8, std::uint16_t(3)), "version 3");
    expectImporterError(changed(10, std::uint16_t(16)), "unknown columns");
    expectImporterError(changed(12, std::uint32_t(16)), "unknown bits");
    expectImporterError(changed(24, -1.0), "a grid step");
    expectImporterError(changed(24, nan), "a grid step");
    expectImporterError(changed(48, infinity), "the grid's origin");
    expectImporterError(changed(124, std::uint32_t(257)), "format text is too long");
    expectImporterError(changed(128, std::uint32_t(0x7fffffff)), "WKT text is too long");
    expectImporterError(changed(132, std::uint32_t(1) << 19), "list of columns is too long");
    expectImporterError(changed(132, std::uint32_t(1)), "no JSON list");
    expectImporterError(changed(chunkAt, 'X'), "a record of unknown kind");
    expectImporterError(changed(chunkAt + 4, std::uint32_t(0)), "a chunk of 0 points");
    expectImporterError(changed(chunkAt + 4, std::uint32_t(65537)), "a chunk of 65,537 points");
    expectImporterError(changed(chunkAt + 4, std::uint32_t(3)), "more points than the 2 that it declared");
    expectImporterError(changed(chunkAt + 8, nan), "a coordinate is NaN or infinite");
    expectImporterError(changed(chunkAt + 8 + 40, infinity), "a coordinate is NaN or infinite");
    expectImporterError(changed(doneAt - 4, 3.0F), "a normal is neither");
    expectImporterError(changed(doneAt - 4, std::numeric_limits<float>::quiet_NaN()), "a normal is neither");
    expectImporterError(changed(doneAt + 4, std::uint32_t(1)), "its end record has a length");
    expectImporterError(changed(doneAt + 8, std::uint64_t(3)), "claims to have sent 3 points, it has sent 2");
    expectImporterError(changed(doneAt + 16, std::uint64_t(1)), "declared 2 points, sent 2 and dropped 1");
    expectImporterError(changed(16, std::uint64_t(5)), "declared 5 points");
}

TEST(PointStream, AScannerThatIsNowhereIsAnError) {
    Recorder recorder;
    ScanHeader header = headerOf({});
    header.scannerOrigin = {0, std::numeric_limits<double>::quiet_NaN(), 0};
    ASSERT_TRUE(recorder.writer.writeHeader(header));
    expectImporterError(recorder.bytes, "the scanner's place is not a number");
}

TEST(PointStream, NotesAreHeardWhereverTheyStand) {
    Recorder recorder;
    ASSERT_TRUE(recorder.writer.writeHeader(headerOf(all, 4)));
    ASSERT_TRUE(recorder.writer.writeNote("cloud.js says 5 \x01 points"));
    ASSERT_TRUE(recorder.writer.writeChunk(batchOf(2, all)));
    ASSERT_TRUE(recorder.writer.writeNote(std::string(9000, 'x')));
    ASSERT_TRUE(recorder.writer.writeChunk(batchOf(2, all)));
    ASSERT_TRUE(recorder.writer.writeNote("the last"));
    ASSERT_TRUE(recorder.writer.finish(0));
    const auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(recorder.bytes, false));
    ASSERT_TRUE(reader) << reader.error().message;
    PointBatch batch;
    std::size_t points = 0;
    while ((*reader)->read(batch).value()) points += batch.size();
    EXPECT_EQ(points, 4U);
    EXPECT_EQ((*reader)->notes(),
              (std::vector<std::string>{"cloud.js says 5 ? points", std::string(1024, 'x'), "the last"}));
}

TEST(PointStream, NotesThatLieAreErrors) {
    const auto withNotes = [](std::uint32_t bytes, int count) {
        auto stream = small();
        for (int i = 0; i < count; ++i) {
            Bytes note(8 + bytes, std::byte('x'));
            put(note, 0, std::array<char, 4>{'N', 'O', 'T', 'E'});
            put(note, 4, bytes);
            stream.insert(stream.begin() + chunkAt, note.begin(), note.end());
        }
        return stream;
    };
    EXPECT_TRUE(readStream(withNotes(1024, 32)));
    expectImporterError(withNotes(1025, 1), "a note of 1,025 bytes");
    expectImporterError(withNotes(0, 1), "a note of 0 bytes");
    expectImporterError(withNotes(3, 33), "more than 32 notes");
}

/// A sound stream with `parts` to look at first, each of two points.
Bytes withGlance(int parts, bool ended = true) {
    Bytes glance;
    const Bytes whole = small();
    for (int i = 0; i < parts; ++i)
        glance.insert(glance.end(), whole.begin() + chunkAt, whole.begin() + doneAt);
    if (ended) glance.resize(glance.size() + 8);
    for (std::size_t at = 0; at < glance.size(); at += doneAt - chunkAt)
        put(glance, at, std::array<char, 4>{'L', 'O', 'O', 'K'});
    Bytes stream = whole;
    stream.insert(stream.begin() + chunkAt, glance.begin(), glance.end());
    return stream;
}

TEST(PointStream, AGlanceIsSeenFirstAndCountsForNothing) {
    for (const bool ended : {true, false})
        for (const int parts : {0, 1, 5}) {
            const Bytes bytes = withGlance(parts, ended);
            EXPECT_EQ(readStream(bytes).value().points, 2U) << "whoever does not want it";
            auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false));
            ASSERT_TRUE(reader) << reader.error().message;
            const PointBatch glance = (*reader)->glance().value();
            ASSERT_EQ(glance.size(), std::size_t(2 * parts));
            ASSERT_EQ(glance.normal.size(), glance.size());
            for (std::size_t i = 0; i < glance.size(); ++i)
                EXPECT_EQ(glance.position[i], batchOf(2, all).position[i % 2]);
            EXPECT_EQ((*reader)->glance().value().size(), 0U) << "once";
            PointBatch batch;
            EXPECT_TRUE((*reader)->read(batch).value());
            EXPECT_TRUE(batch.position == batchOf(2, all).position);
            EXPECT_FALSE((*reader)->read(batch).value());
        }
}

// Right because the bytes end there: to wait for more would be an error.
TEST(PointStream, AGlanceWaitsForNothingBehindIt) {
    Bytes bytes = withGlance(3);
    bytes.resize(bytes.size() - (small().size() - chunkAt));
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false));
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->glance().value().size(), 6U);
    PointBatch batch;
    EXPECT_THAT((*reader)->read(batch).error().message, HasSubstr("broke off"));
}

TEST(PointStream, GlancesThatLieAreErrors) {
    const Bytes good = withGlance(1);
    for (std::size_t size = chunkAt; size < good.size(); ++size)
        expectImporterError(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)),
                            "broke off");
    Bytes nan = good;
    put(nan, chunkAt + 8, std::numeric_limits<double>::quiet_NaN());
    expectImporterError(nan, "a coordinate is NaN");
    Bytes many = good;
    put(many, chunkAt + 4, std::uint32_t(65537));
    expectImporterError(many, "more than 65,536 points to look at first");
    Bytes twice = withGlance(0);
    const Bytes again = withGlance(0);
    twice.insert(twice.begin() + chunkAt, again.begin() + chunkAt, again.begin() + chunkAt + 8);
    expectImporterError(twice, "a record of unknown kind");
    Bytes late = small();
    late.insert(late.begin() + doneAt, again.begin() + chunkAt, again.begin() + chunkAt + 8);
    expectImporterError(late, "points to look at first, behind others");
}

TEST(PointStream, NoMorePointsThanTheFileCanHold) {
    EXPECT_TRUE(readStream(small(std::nullopt), 2));
    const auto scan = readStream(small(std::nullopt), 1);
    ASSERT_FALSE(scan);
    EXPECT_THAT(scan.error().message, HasSubstr("more points than such a file can hold"));
}

TEST(PointStream, FailuresCarryTheirCode) {
    for (const auto code : {ErrorCode::Malformed, ErrorCode::Truncated, ErrorCode::Empty,
                            ErrorCode::Unsupported, ErrorCode::Io, ErrorCode::ResourceLimit}) {
        Recorder atOnce;
        ASSERT_TRUE(atOnce.writer.writeFailure({code, "out of \x01 paper", {}}));
        // Before the first point: the scan does not even open.
        const auto opened =
            PointStreamReader::create(std::make_unique<MemoryByteSource>(atOnce.bytes, false));
        ASSERT_FALSE(opened);
        EXPECT_EQ(opened.error().code, code);
        EXPECT_EQ(opened.error().message, "out of ? paper");

        Recorder later;
        ASSERT_TRUE(later.writer.writeHeader(headerOf({}, 100)));
        ASSERT_TRUE(later.writer.writeChunk(batchOf(5, {})));
        ASSERT_TRUE(later.writer.writeFailure({code, std::string(9000, 'x'), {}}));
        const auto scan = readStream(later.bytes);
        ASSERT_FALSE(scan);
        EXPECT_EQ(scan.error().code, code);
        EXPECT_EQ(scan.error().message.size(), 4096U);
    }
}

TEST(PointStream, NoPointsAreEmpty) {
    for (const std::uint64_t dropped : {0, 12}) {
        Recorder recorder;
        ASSERT_TRUE(recorder.writer.writeHeader(headerOf({})));
        ASSERT_TRUE(recorder.writer.finish(dropped));
        const auto scan = readStream(recorder.bytes);
        ASSERT_FALSE(scan);
        EXPECT_EQ(scan.error().code, ErrorCode::Empty);
    }
}

}  // namespace scancast::test
