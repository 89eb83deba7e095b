// Version 2 of the point stream: records of LAS mean what they mean in a file, positions as steps are exact, and what lies
// is an error.
#include <gmock/gmock.h>

#include "renderer/cloud/import/las/las_source.hpp"
#include "renderer/cloud/import/stream/frame_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "tests/unit/import/las_bytes.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

using RawBytes = std::vector<std::byte>;

struct Tape {
    RawBytes bytes;
    PointStreamWriter writer{[this](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }};
};

LasFile scanOf(int minor, int format, int points, std::uint16_t colorScale = 1) {
    LasFile file;
    file.minor = minor;
    file.format = format;
    file.flags = true;
    for (int i = 0; i < points; ++i) {
        LasPoint p{.x = 3 * i - 1000000, .y = 7 * i, .z = -i};
        p.intensity = static_cast<std::uint16_t>(i * 11);
        p.classification = static_cast<std::uint8_t>(i % 32);
        p.red = static_cast<std::uint16_t>((i % 256) * colorScale);
        p.blue = static_cast<std::uint16_t>((255 - i % 256) * colorScale);
        file.points.push_back(p);
    }
    return file;
}

/// A LAS file taken apart as an importer would.
struct LasInParts {
    explicit LasInParts(const LasFile& file) : bytes(file.bytes()), count(file.points.size()) {
        std::uint32_t offset = 0;
        std::memcpy(&offset, bytes.data() + 96, 4);
        std::memcpy(&recordBytes, bytes.data() + 105, 2);
        head = std::span(bytes).first(offset);
        records = std::span(bytes).subspan(offset, count * recordBytes);
        evlrs = std::span(bytes).subspan(offset + records.size());
    }
    point_stream::LasPreamble preamble() const { return {"LAZ test", count, head, evlrs}; }
    std::span<const std::byte> some(std::size_t first, std::size_t n) const {
        return records.subspan(first * recordBytes, n * recordBytes);
    }

    RawBytes bytes;
    std::uint64_t count;
    std::uint16_t recordBytes = 0;
    std::span<const std::byte> head, records, evlrs;
};

RawBytes streamOf(const LasInParts& las, std::optional<std::uint16_t> peak = std::nullopt) {
    Tape tape;
    EXPECT_TRUE(tape.writer.writeLasHeader(las.preamble()));
    if (peak) {
        EXPECT_TRUE(tape.writer.writePeak(*peak));
    }
    for (std::size_t first = 0; first < las.count; first += 37)
        EXPECT_TRUE(tape.writer.writeRecords(las.some(first, std::min<std::size_t>(37, las.count - first))));
    EXPECT_TRUE(tape.writer.finish(0));
    return tape.bytes;
}

struct Whole {
    ScanHeader header;
    PointBatch points;
    std::uint64_t dropped = 0;
    std::vector<std::string> notes;
};

template <class Source>
Expected<Whole> readWhole(Expected<std::unique_ptr<Source>> source) {
    if (!source) return passOn(source);
    Whole whole{(*source)->header(), {}, 0, {}};
    PointBatch batch;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        EXPECT_GT(batch.size(), 0U);
        append(whole.points, batch);
    }
    whole.dropped = (*source)->droppedPoints();
    whole.notes = (*source)->notes();
    return whole;
}

Expected<Whole> readTape(const RawBytes& bytes, bool keep = false) {
    return readWhole(PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false),
                                               {.keepAttributes = keep}));
}

Expected<Whole> readFile(const RawBytes& bytes, bool keep = false) {
    return readWhole(LasSource::create(std::make_unique<MemoryByteSource>(bytes, true), "a.las", keep));
}

void expectSamePoints(const PointBatch& a, const PointBatch& b) {
    EXPECT_TRUE(a.position == b.position);
    EXPECT_TRUE(a.color == b.color);
    EXPECT_TRUE(a.intensity == b.intensity);
    EXPECT_TRUE(a.classification == b.classification);
    EXPECT_TRUE(a.rows == b.rows);
}

void expectLie(const RawBytes& bytes, const char* reason, ErrorCode code = ErrorCode::Importer) {
    const auto read = readTape(bytes);
    ASSERT_FALSE(read) << reason;
    EXPECT_EQ(name(read.error().code), name(code)) << read.error().message;
    EXPECT_THAT(read.error().message, HasSubstr(reason));
}

}  // namespace

// Right because the reader of files is tested against the tables of the standard: whatever that makes of a file, the stream
// of its parts has to be.
TEST(PointStreamLas, RecordsSayWhatTheFileSays) {
    for (int format = 0; format <= 10; ++format)
        for (int minor = format >= 6 ? 4 : 2; minor <= 5; ++minor)
            for (const bool keep : {false, true}) {
                SCOPED_TRACE(testing::Message()
                             << "1." << minor << ", point format " << format << ", " << keep);
                LasFile file = scanOf(minor, format, 100, format % 2 == 0 ? 1 : 257);
                file.extraBytes = 5;
                std::string extra(192, '\0');
                extra[2] = 4;  // int16
                extra.replace(4, 9, "amplitude");
                const std::string wkt = "PROJCS[\"a\",AUTHORITY[\"EPSG\",\"25832\"]]";
                file.records = {{minor >= 4, "LASF_Projection", 2112, wkt}, {false, "LASF_Spec", 4, extra}};
                const LasInParts las(file);
                const auto truth = readFile(las.bytes, keep);
                const auto read = readTape(streamOf(las, 65535), keep);
                ASSERT_TRUE(truth && read) << read.error().message;
                EXPECT_EQ(read->header.format, "LAZ test");
                EXPECT_EQ(read->header.points, 100U);
                EXPECT_EQ(read->header.attributes, truth->header.attributes);
                EXPECT_EQ(read->header.gridStep, truth->header.gridStep);
                EXPECT_EQ(read->header.gridOrigin, truth->header.gridOrigin);
                EXPECT_EQ(read->header.bounds, truth->header.bounds);
                EXPECT_EQ(read->header.crsWkt, wkt);
                EXPECT_EQ(read->header.crsEpsg, 25832);
                EXPECT_EQ(read->header.columns, truth->header.columns);
                EXPECT_EQ(read->header.columns.empty(), !keep);
                if (!lasHasColor(format) || format % 2 != 0) expectSamePoints(read->points, truth->points);
                EXPECT_EQ(read->notes.size(), truth->notes.size());
                EXPECT_EQ(read->notes.empty(), format != 4 && format != 5 && format < 9);
                if (!read->notes.empty()) {
                    EXPECT_EQ("a.las: " + read->notes[0], truth->notes[0]);
                }
            }
}

// The file reader looks at all colours first; a stream may be told, may be shown some, or has to be refused.
TEST(PointStreamLas, ColoursHaveTheDepthOfAllOfThem) {
    LasFile dark = scanOf(2, 2, 120), bright = dark;
    bright.points[100].green = 300;
    for (const auto& [file, peak] : {std::pair{dark, 255}, {bright, 300}, {bright, 65535}}) {
        const LasInParts las(file);
        const auto read = readTape(streamOf(las, static_cast<std::uint16_t>(peak)));
        ASSERT_TRUE(read) << read.error().message;
        expectSamePoints(read->points, readFile(las.bytes)->points);
    }
    const LasInParts las(bright);
    expectLie(streamOf(las), "have 8 bits, later ones 16", ErrorCode::Unsupported);
    expectLie(streamOf(las, 255), "no colour is above 255, and one is");
    Tape shown;
    ASSERT_TRUE(shown.writer.writeLasHeader(las.preamble()));
    ASSERT_TRUE(shown.writer.writeGlanceOfRecords(las.some(99, 2)));
    ASSERT_TRUE(shown.writer.endGlance());
    ASSERT_TRUE(shown.writer.writeRecords(las.records));
    ASSERT_TRUE(shown.writer.finish(0));
    const auto read = readTape(shown.bytes);
    ASSERT_TRUE(read) << read.error().message;
    expectSamePoints(read->points, readFile(las.bytes)->points);
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(shown.bytes, false));
    ASSERT_TRUE(reader);
    const PointBatch glance = (*reader)->glance().value();
    ASSERT_EQ(glance.size(), 2U);
    EXPECT_EQ(glance.position[1], read->points.position[100]);
}

TEST(PointStreamLas, PointsWithoutAPlaceAreDroppedByTheReader) {
    LasFile file = scanOf(2, 3, 100);
    file.scale = 1e300;
    file.offset = 0;
    for (std::size_t i = 0; i < 100; ++i)
        file.points[i].x = file.points[i].y = file.points[i].z = i < 40 || i == 77 ? 2000000000 : int(i);
    const LasInParts las(file);
    const auto read = readTape(streamOf(las, 255), true);
    const auto truth = readFile(las.bytes, true);
    ASSERT_TRUE(read && truth) << read.error().message;
    EXPECT_EQ(read->dropped, 41U);
    expectSamePoints(read->points, truth->points);
    for (auto& p : file.points) p.x = 2000000000;
    expectLie(streamOf(LasInParts(file), 255), "none of its 100 points", ErrorCode::Empty);
}

// An importer that gives what there is of a file without an end does not know how much that is.
TEST(PointStreamLas, ANumberThatIsNotKnownIsNotHeld) {
    const LasInParts las(scanOf(4, 7, 100, 257));
    for (const bool known : {true, false}) {
        Tape tape;
        auto preamble = las.preamble();
        if (!known) preamble.points.reset();
        ASSERT_TRUE(tape.writer.writeLasHeader(preamble));
        ASSERT_TRUE(tape.writer.writeRecords(las.some(0, 60)));
        ASSERT_TRUE(tape.writer.finish(0));
        if (known) {
            expectLie(tape.bytes, "declared 100 points, sent 60");
            continue;
        }
        const auto read = readTape(tape.bytes);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(read->header.points, std::nullopt);
        EXPECT_EQ(read->points.size(), 60U);
    }
}

TEST(PointStreamLas, TruncatedAtEveryByte) {
    const auto whole = streamOf(LasInParts(scanOf(2, 2, 3)), 255);
    ASSERT_TRUE(readTape(whole));
    for (std::size_t size = 0; size < whole.size(); ++size)
        expectLie(RawBytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)), "broke off");
}

// The page POINT_STREAM.md says where things are: header, "LAZ test", two lengths, head, PEAK, RECS.
TEST(PointStreamLas, LiesAreErrors) {
    const LasInParts las(scanOf(2, 2, 3));
    const auto whole = streamOf(las, 255);
    constexpr std::size_t lengthsAt = 136 + 8, headAt = lengthsAt + 8;
    const std::size_t peakAt = headAt + 227, recordsAt = peakAt + 8, doneAt = recordsAt + 8 + 3 * 26;
    ASSERT_EQ(whole.size(), doneAt + 24);
    const auto with = [&](std::size_t at, auto value) {
        auto bytes = whole;
        put(bytes, at, value);
        return bytes;
    };
    expectLie(with(8, std::uint16_t(3)), "version 3");
    expectLie(with(8, std::uint16_t(1)), "unknown columns");
    expectLie(with(10, std::uint16_t(17)), "other columns beside records of LAS");
    expectLie(with(10, std::uint16_t(48)), "unknown columns");
    expectLie(with(12, std::uint32_t(3)), "nothing but their number");
    expectLie(with(12, std::uint32_t(64)), "unknown bits");
    expectLie(with(24, 0.5), "a grid beside records of LAS");
    expectLie(with(128, std::uint32_t(5)), "texts beside records of LAS");
    expectLie(with(16, std::uint64_t(4)), "it declares 4 points, the head of LAS 3");
    expectLie(with(lengthsAt, std::uint32_t(1) << 25), "a head of LAS of 33,554,432 bytes");
    expectLie(with(lengthsAt + 4, std::uint32_t(1) << 25), "extended records of LAS of 33,554,432 bytes");
    expectLie(with(lengthsAt, std::uint32_t(200)), "it ends at byte 200", ErrorCode::Truncated);
    expectLie(with(lengthsAt, std::uint32_t(230)), "a head of LAS of 230 bytes");
    expectLie(with(headAt, 'X'), "byte 0: not a LAS file", ErrorCode::Malformed);
    expectLie(with(headAt + 94, std::uint16_t(400)), "within the header", ErrorCode::Malformed);
    expectLie(with(headAt + 104, std::uint8_t(0x82)), "its head is one of LAZ");
    expectLie(with(headAt + 104, std::uint8_t(11)), "byte 104: point format 11", ErrorCode::Unsupported);
    expectLie(with(headAt + 107, std::uint32_t(0)), "it is a LAS file without points", ErrorCode::Empty);
    expectLie(with(peakAt + 4, std::uint32_t(65536)), "a colour of more than 16 bits");
    expectLie(with(recordsAt, std::array<char, 4>{'P', 'E', 'A', 'K'}), "the highest colour twice");
    expectLie(with(recordsAt, std::array<char, 4>{'C', 'H', 'N', 'K'}), "a record of unknown kind");
    expectLie(with(recordsAt + 4, std::uint32_t(0)), "a chunk of 0 points");
    expectLie(with(recordsAt + 4, std::uint32_t(65537)), "a chunk of 65,537 points");
    expectLie(with(recordsAt + 4, std::uint32_t(4)), "more points than the 3 that it declared");
    expectLie(with(doneAt + 16, std::uint64_t(1)), "not dropped by who sends them");
    expectLie(with(doneAt, std::array<char, 4>{'P', 'E', 'A', 'K'}), "the highest colour twice, or behind");

    LasFile wide = scanOf(2, 0, 3);
    wide.extraBytes = 60000;
    const LasInParts wideLas(wide);
    auto bytes = streamOf(wideLas);
    ASSERT_TRUE(readTape(bytes));
    put(bytes, lengthsAt + 8 + 107, std::uint32_t(60000));
    put(bytes, 16, std::uint64_t(60000));
    put(bytes, headAt + 227 + 4, std::uint32_t(300));
    expectLie(bytes, "18,006,000 bytes of records of LAS at once");
}

// Long records go in pieces that the page allows.
TEST(PointStreamLas, TheWriterDividesWhatIsTooMuchAtOnce) {
    LasFile file = scanOf(2, 0, 600);
    file.extraBytes = 60000;
    const LasInParts las(file);
    Tape tape;
    ASSERT_TRUE(tape.writer.writeLasHeader(las.preamble()));
    ASSERT_TRUE(tape.writer.writeRecords(las.records));
    ASSERT_TRUE(tape.writer.finish(0));
    const auto read = readTape(tape.bytes);
    ASSERT_TRUE(read) << read.error().message;
    expectSamePoints(read->points, readFile(las.bytes)->points);
}

namespace {

ScanHeader headerOfSteps() {
    ScanHeader header;
    header.format = "STEPS";
    header.attributes.intensity = true;
    header.gridStep = {0.001, 0.01, 0.5};
    header.gridOrigin = {4.5e6, -3, 0.1};
    return header;
}

PointBatch batchOfSteps() {
    const ScanHeader header = headerOfSteps();
    PointBatch batch;
    batch.position.steps({header.gridOrigin, header.gridStep}) = {
        {0, 1, 2}, {2147483647, -2147483647 - 1, 5}, {-77, 123456789, -123456789}};
    batch.intensity = {1, 2, 3};
    return batch;
}

RawBytes streamOfSteps() {
    Tape tape;
    EXPECT_TRUE(tape.writer.writeHeaderOfSteps(headerOfSteps()));
    EXPECT_TRUE(tape.writer.writeGlance(batchOfSteps()));
    EXPECT_TRUE(tape.writer.endGlance());
    EXPECT_TRUE(tape.writer.writeChunk(batchOfSteps()));
    EXPECT_TRUE(tape.writer.finish(0));
    return tape.bytes;
}

}  // namespace

TEST(PointStreamSteps, ArriveAsTheyWereSent) {
    const auto bytes = streamOfSteps();
    EXPECT_EQ(bytes[8], std::byte(2));
    EXPECT_EQ(bytes[12], std::byte(16));
    EXPECT_EQ(bytes.size(), 136 + 5 + 2 * (8 + 3 * (12 + 2)) + 8 + 24U);
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false));
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->glance().value().position, batchOfSteps().position);
    PointBatch batch;
    ASSERT_TRUE((*reader)->read(batch).value());
    ASSERT_TRUE(batch.position.areSteps());
    EXPECT_TRUE(std::ranges::equal(batch.position.asSteps(), batchOfSteps().position.asSteps()));
    EXPECT_EQ(batch.position[2],
              glm::dvec3(4.5e6 + 0.001 * -77, -3 + 0.01 * 123456789, 0.1 + 0.5 * -123456789));
    EXPECT_EQ(batch.intensity[2], 3);
    EXPECT_FALSE((*reader)->read(batch).value());
}

TEST(PointStreamSteps, OfNoGridAreErrors) {
    for (const double step : {0.0, 1e300}) {
        auto bytes = streamOfSteps();
        put(bytes, 32, step);
        expectLie(bytes, "there is none that they could be of");
    }
    auto bytes = streamOfSteps();
    put(bytes, 8, std::uint16_t(1));
    expectLie(bytes, "unknown bits");
}

// A live source may send either; a frame has float64 positions.
TEST(PointStreamSteps, FramesMayBeOfVersion2) {
    RawBytes bytes = streamOfSteps();
    const auto las = streamOf(LasInParts(scanOf(4, 7, 50, 257)), 65535);
    bytes.insert(bytes.end(), las.begin(), las.end());
    FrameReader frames(std::make_unique<MemoryByteSource>(bytes, false), 1000);
    const auto first = frames.next();
    ASSERT_TRUE(first && *first);
    EXPECT_FALSE((*first)->points.position.areSteps());
    EXPECT_EQ((*first)->points.position, batchOfSteps().position);
    const auto second = frames.next();
    ASSERT_TRUE(second && *second);
    EXPECT_EQ((*second)->points.size(), 50U);
    EXPECT_FALSE(frames.next().value());
}

}  // namespace scancast::test
