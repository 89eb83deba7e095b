// The LAS reader against files built here, byte by byte from the standard's tables.
#include <gmock/gmock.h>

#include <limits>

#include "renderer/cloud/import/las/las_source.hpp"
#include "tests/unit/import/las_bytes.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

Expected<std::unique_ptr<LasSource>> open(const std::vector<std::byte>& bytes, bool seekable = true) {
    return LasSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "test.las");
}

Expected<ScanSummary> readLas(const std::vector<std::byte>& bytes, bool seekable = true) {
    return summarizeOpened(open(bytes, seekable));
}

LasPoint point(int i, std::uint16_t colorScale) {
    LasPoint p;
    p.x = 3 * i - 1000000;
    p.y = 7 * i;
    p.z = -i;
    p.intensity = static_cast<std::uint16_t>(i * 11);
    p.classification = static_cast<std::uint8_t>(i % 32);
    p.red = static_cast<std::uint16_t>((i % 256) * colorScale);
    p.green = static_cast<std::uint16_t>((i * 3 % 256) * colorScale);
    p.blue = static_cast<std::uint16_t>((255 - i % 256) * colorScale);
    p.infrared = static_cast<std::uint16_t>((i * 5 % 256) * colorScale);
    return p;
}

LasFile sample(int minor, int format, std::uint16_t colorScale, int points = 100) {
    LasFile file;
    file.minor = minor;
    file.format = format;
    file.flags = true;
    for (int i = 0; i < points; ++i) file.points.push_back(point(i, colorScale));
    return file;
}

void expectPoints(const LasFile& file, const PointBatch& batch) {
    ASSERT_EQ(batch.size(), file.points.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto& p = file.points[i];
        const glm::dvec3 expected(file.offset + p.x * file.scale, file.offset + p.y * file.scale,
                                  file.offset + p.z * file.scale);
        ASSERT_EQ(batch.position[i], expected);
        ASSERT_EQ(batch.intensity[i], p.intensity);
        ASSERT_EQ(batch.classification[i], p.classification);
        const auto k = static_cast<int>(i);
        const std::array<std::uint8_t, 3> color{static_cast<std::uint8_t>(k % 256),
                                                static_cast<std::uint8_t>(k * 3 % 256),
                                                static_cast<std::uint8_t>(255 - k % 256)};
        if (!batch.color.empty()) {
            ASSERT_EQ(batch.color[i], color);
        }
        ASSERT_EQ(batch.nearInfrared.size(), lasHasInfrared(file.format) ? batch.size() : 0);
        if (lasHasInfrared(file.format)) {
            ASSERT_EQ(batch.nearInfrared[i], p.infrared) << "its depth is the builder's to find";
        }
    }
}

void expectLasError(const std::vector<std::byte>& bytes, ErrorCode code, const char* reason) {
    for (const bool seekable : {true, false}) {
        const auto scan = readLas(bytes, seekable);
        ASSERT_FALSE(scan) << reason;
        EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
        EXPECT_THAT(scan.error().message, HasSubstr("test.las"));
        EXPECT_THAT(scan.error().message, HasSubstr(reason));
    }
}

}  // namespace

class LasFormats : public ::testing::TestWithParam<int> {};

// What was written is what is read: the writer knows the fields' places from the standard, not from the
// reader. Colours: 8 bits as such, × 256 and × 257 are the three ways in which programs store an 8-bit
// colour.
TEST_P(LasFormats, RoundTrip) {
    const int format = GetParam();
    for (int minor = 0; minor <= 5; ++minor)
        for (const std::uint16_t colorScale : {1, 256, 257})
            for (const bool seekable : {true, false}) {
                SCOPED_TRACE(testing::Message()
                             << "1." << minor << ", colour × " << colorScale << ", file " << seekable);
                auto file = sample(minor, format, colorScale);
                file.extraBytes = minor % 2 == 0 ? 0 : 7;
                const auto bytes = file.bytes();
                const auto source = open(bytes, seekable);
                ASSERT_TRUE(source) << source.error().message;
                const auto& header = (*source)->header();
                EXPECT_EQ(header.attributes,
                          (Attributes{lasHasColor(format), true, true, false, lasHasInfrared(format)}));
                EXPECT_EQ(header.points, 100U);
                EXPECT_EQ(header.gridStep, glm::dvec3(0.01));
                EXPECT_EQ(header.gridOrigin, glm::dvec3(1000));
                const auto scan = summarize(**source);
                ASSERT_TRUE(scan) << scan.error().message;
                expectPoints(file, scan->first);
            }
}

INSTANTIATE_TEST_SUITE_P(All, LasFormats, ::testing::Range(0, 11));

// More points than a batch, and records longer than the buffer would like: the order is kept over every seam.
TEST(LasSource, ManyBatches) {
    for (const std::uint16_t extra : {0, 3000}) {
        LasFile file = sample(2, 2, 1, extra == 0 ? 200000 : 3000);
        file.extraBytes = extra;
        const auto bytes = file.bytes();
        for (const bool seekable : {true, false}) {
            const auto source = open(bytes, seekable);
            ASSERT_TRUE(source);
            PointBatch batch;
            std::size_t done = 0;
            for (;;) {
                const auto more = (*source)->read(batch);
                ASSERT_TRUE(more) << more.error().message;
                if (!*more) break;
                ASSERT_LE(batch.size(), PointSource::batchPoints);
                for (std::size_t i = 0; i < batch.size(); ++i)
                    ASSERT_EQ(batch.position[i].y, 1000 + file.points[done + i].y * 0.01);
                done += batch.size();
            }
            EXPECT_EQ(done, file.points.size());
            EXPECT_EQ((*source)->bytesRead()[0], (*source)->bytesRead()[1]);
        }
    }
}

// Right because y says which point it is: a glance is of points from everywhere, and read() gives all of them.
TEST(LasSource, AGlanceIsOfTheWholeScan) {
    LasFile file = sample(2, 2, 1, 1'000'000);
    for (std::size_t i = 0; i < file.points.size(); ++i) file.points[i].y = static_cast<std::int32_t>(i);
    const auto bytes = file.bytes();
    for (const bool seekable : {true, false}) {
        const auto source = open(bytes, seekable);
        ASSERT_TRUE(source);
        const PointBatch glance = (*source)->glance().value();
        PointBatch batch;
        ASSERT_TRUE((*source)->read(batch).value());
        EXPECT_EQ(batch.position.front().y, 1000.0);
        if (!seekable) {
            EXPECT_EQ(glance.size(), 0U) << "a pipe is read once";
            continue;
        }
        ASSERT_GT(glance.size(), 10'000U);
        ASSERT_LE(glance.size(), 65'536U);
        EXPECT_EQ(glance.color.size(), glance.size());
        std::vector<int> tenths(10, 0);
        for (const glm::dvec3& p : glance.position) {
            const double number = (p.y - 1000) / 0.01;
            ASSERT_NEAR(number, std::round(number), 1e-5);
            ++tenths.at(std::size_t(number / 100'000));
        }
        for (const int count : tenths) EXPECT_NEAR(count, double(glance.size()) / 10, glance.size() / 100.0);
    }
}

TEST(LasSource, SmallScansAreReadAtOnce) {
    const auto source = open(sample(2, 2, 1, 1000).bytes(), true);
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->glance().value().size(), 0U);
}

// A single number above 255, wherever it is and in whichever channel, makes the file a 16-bit one.
TEST(LasSource, OneBrightPointDecidesTheColourDepth) {
    for (const std::size_t bright : {std::size_t(0), std::size_t(70001), std::size_t(149999)})
        for (const auto channel : {&LasPoint::red, &LasPoint::green, &LasPoint::blue}) {
            LasFile file = sample(2, 2, 1, 150000);
            for (auto& p : file.points) p.red = p.green = p.blue = 200;
            file.points[bright].*channel = 256;
            const auto scan = readLas(file.bytes());
            ASSERT_TRUE(scan);
            EXPECT_EQ(scan->colorMax, 1);  // 200 of 65,535 is black
        }
}

// Right because whoever looks at all of the file by itself, when it is opened, has nobody to hear it from.
TEST(LasSource, LookedAtInPartsItIsReadAsLookedAtAtOnce) {
    constexpr int points = 9000, middle = 4321;
    for (const bool isBright : {false, true}) {
        LasFile file = sample(2, 2, 1, points);
        if (isBright) file.points[middle].green = 256;  // where no first look is taken
        const auto bytes = file.bytes();
        const auto openInParts = [&] {
            return LasSource::create(std::make_unique<MemoryByteSource>(bytes, true), "test.las", false,
                                     false, false, true)
                .value();
        };
        const auto expected = readLas(bytes);
        ASSERT_TRUE(expected);
        const auto shared = openInParts();
        ASSERT_TRUE(shared->wantsToBeSeen());
        EXPECT_EQ(shared->lookAt(0, middle).value(), 255U);
        const std::uint16_t rest = openInParts()->lookAt(middle, points).value();
        EXPECT_EQ(rest > 255, isBright);
        shared->hasSeen(std::max<std::uint16_t>(rest, 255));
        EXPECT_FALSE(shared->wantsToBeSeen());
        PointBatch told, alone, once;
        ASSERT_TRUE(shared->read(told).value());
        ASSERT_TRUE(openInParts()->read(alone).value()) << "nobody has said anything";
        const auto whole = open(bytes).value();
        EXPECT_FALSE(whole->wantsToBeSeen());
        ASSERT_TRUE(whole->read(once).value());
        EXPECT_EQ(told.color, once.color);
        EXPECT_EQ(alone.color, once.color);
    }
}

TEST(LasSource, ContradictoryColoursOfAPipeAreAnError) {
    LasFile file = sample(2, 2, 1, 150000);
    for (auto& p : file.points) p.red = p.green = p.blue = 200;
    file.points[149999].blue = 256;
    const auto scan = readLas(file.bytes(), false);
    ASSERT_FALSE(scan);
    EXPECT_THAT(scan.error().message, HasSubstr("save the scan to a file"));
}

// Black says nothing about the depth: the first colours of a pipe that are not black decide.
TEST(LasSource, BlackStartOfAPipe) {
    LasFile file = sample(2, 2, 256, 150000);
    for (std::size_t i = 0; i < 100000; ++i)
        file.points[i].red = file.points[i].green = file.points[i].blue = 0;
    const auto scan = readLas(file.bytes(), false);
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->colorMax, 255);
}

// Every prefix of a file is an error of the right kind or, when only other records are cut, still the whole
// cloud.
TEST(LasSource, TruncatedAtEveryByte) {
    LasFile file = sample(4, 7, 256, 3);
    file.records = {{false, "LASF_Projection", 2112, "GEOGCS[]"},
                    {true, "LASF_Projection", 2112, "PROJCS[]"}};
    const auto whole = file.bytes();
    const auto pointsEnd = whole.size() - 60 - 8;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        for (const bool seekable : {true, false}) {
            const auto scan = readLas(cut, seekable);
            ASSERT_EQ(scan.has_value(), size >= pointsEnd) << size;
            if (scan) continue;
            const auto code = scan.error().code;
            ASSERT_TRUE(code == ErrorCode::Truncated || code == ErrorCode::Malformed) << size;
            if (size >= 4) {
                ASSERT_THAT(scan.error().message, HasSubstr("byte")) << size;
            }
        }
    }
}

TEST(LasSource, TruncatedPointsAreCounted) {
    auto bytes = sample(2, 0, 1, 50).bytes();
    bytes.resize(227 + 20 * 30 + 5);
    expectLasError(bytes, ErrorCode::Truncated,
                   "ends at byte 832: its header promises 50 points, there are 30");
}

// More points than 32 bits count: a LAS 1.4 header says so in its 64-bit field, and the old field is 0.
TEST(LasSource, CountsBeyond32Bits) {
    auto bytes = sample(4, 6, 1, 3).bytes();
    put(bytes, 247, std::uint64_t(5000000000));
    const auto scan = readLas(bytes);
    ASSERT_FALSE(scan);
    EXPECT_THAT(scan.error().message, HasSubstr("promises 5,000,000,000 points, there are 3"));
    // A pipe has no size to check it against; the header stands until the pipe ends.
    const auto source = open(bytes, false);
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->header().points, 5000000000U);
    put(bytes, 247, std::numeric_limits<std::uint64_t>::max());
    EXPECT_FALSE(open(bytes, true));
    EXPECT_FALSE(open(bytes, false));
}

// Waveforms lie elsewhere: their points are read, and that they are not is said.
TEST(LasSource, WaveformsArePassedOver) {
    for (int format = 0; format <= 10; ++format) {
        const auto bytes = sample(format >= 6 ? 4 : 3, format, 1).bytes();
        const auto source = open(bytes);
        ASSERT_TRUE(source);
        const bool has = format == 4 || format == 5 || format == 9 || format == 10;
        ASSERT_EQ((*source)->notes().size(), has ? 1U : 0U) << format;
        if (has) {
            EXPECT_THAT((*source)->notes()[0], testing::StartsWith("test.las: its points are all read"));
        }
    }
}

TEST(LasSource, TheOldCountServesWhereTheNewOneIsZero) {
    auto bytes = sample(4, 3, 1, 3).bytes();
    put(bytes, 247, std::uint64_t(0));
    const auto scan = readLas(bytes);
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points, 3U);
}

TEST(LasSource, RefusesWhatMakesPointsDoubtful) {
    const auto whole = sample(2, 3, 1, 5).bytes();
    const auto changed = [&](std::size_t at, auto value) {
        auto bytes = whole;
        put(bytes, at, value);
        return bytes;
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    expectLasError(changed(139, 0.0), ErrorCode::Malformed, "byte 139: the scale of y is 0");
    expectLasError(changed(131, -0.01), ErrorCode::Malformed, "the scale of x");
    expectLasError(changed(147, nan), ErrorCode::Malformed, "the scale of z");
    expectLasError(changed(163, nan), ErrorCode::Malformed, "the offset of y is not a number");
    expectLasError(changed(105, std::uint16_t(33)), ErrorCode::Malformed,
                   "a point record has 33 bytes; point format 3 needs 34");
    expectLasError(changed(94, std::uint16_t(200)), ErrorCode::Malformed,
                   "the header says that it has 200 bytes");
    expectLasError(changed(96, std::uint32_t(100)), ErrorCode::Malformed, "within the header");
    expectLasError(changed(25, std::uint8_t(6)), ErrorCode::Unsupported,
                   "LAS version 1.6 is not known here; LAS 1.0 to 1.5");
    expectLasError(changed(25, std::uint8_t(5)), ErrorCode::Malformed, "LAS 1.5 needs 393");
    expectLasError(changed(24, std::uint8_t(2)), ErrorCode::Unsupported, "LAS version 2.2");
    expectLasError(changed(104, std::uint8_t(11)), ErrorCode::Unsupported, "point format 11");
    expectLasError(changed(104, std::uint8_t(0x83)), ErrorCode::Unsupported,
                   "LAZ (compressed LAS), which is read from files only");
    expectLasError(changed(107, std::uint32_t(0)), ErrorCode::Empty, "without points");
    const auto beyond = readLas(changed(96, std::uint32_t(4000000000)));
    ASSERT_FALSE(beyond);
    EXPECT_EQ(beyond.error().code, ErrorCode::Malformed);
    EXPECT_THAT(beyond.error().message, HasSubstr("beyond the end of the file"));
}

TEST(LasSource, RefusesRecordsAmongThePoints) {
    LasFile file = sample(4, 6, 1, 5);
    file.records = {{true, "LASF_Projection", 2112, "PROJCS[]"}};
    auto bytes = file.bytes();
    put(bytes, 235, std::uint64_t(400));
    expectLasError(bytes, ErrorCode::Malformed, "among the points");
}

// scale × the largest integer is infinite: such points have no place.
TEST(LasSource, DropsInfinitePoints) {
    LasFile file = sample(2, 3, 1, 10);
    for (auto& p : file.points) p.x = p.y = p.z = 1;
    file.points[4].y = 2000000000;
    file.points[7].z = -2000000000;
    file.scale = 1e300;
    file.offset = 0;
    const auto bytes = file.bytes();
    const auto source = open(bytes);
    ASSERT_TRUE(source);
    const auto scan = summarize(**source);
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points, 8U);
    EXPECT_EQ((*source)->droppedPoints(), 2U);
    // Intensities tell which points are left: 11 × the number of the point.
    EXPECT_THAT(scan->first.intensity, ::testing::ElementsAre(0, 11, 22, 33, 55, 66, 88, 99));

    for (auto& p : file.points) p.x = 2000000000;
    const auto none = readLas(file.bytes());
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::Empty);
}

namespace {

std::string geoKeys(std::vector<std::uint16_t> numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * 2};
}

ScanHeader headerWith(std::vector<LasRecord> records, int minor = 4) {
    LasFile file = sample(minor, minor >= 4 ? 6 : 3, 1, 2);
    file.records = std::move(records);
    const auto bytes = file.bytes();
    const auto source = open(bytes);
    return source ? (*source)->header() : ScanHeader{};
}

}  // namespace

TEST(LasCrs, FromWktAndGeoKeys) {
    using namespace std::string_literals;
    const auto keys = geoKeys({1, 1, 0, 3, 1024, 0, 1, 1, 2048, 0, 1, 4269, 3072, 0, 1, 26915});
    auto header = headerWith({{false, "somebody", 2112, "no"},
                              {false, "LASF_Projection", 34735, keys},
                              {false, "LASF_Projection", 2112, "PROJCS[\"UTM \xe9\"]\0\0rest"s}},
                             2);
    EXPECT_EQ(header.crsEpsg, 26915);
    EXPECT_EQ(header.crsWkt, "PROJCS[\"UTM ?\"]");  // outside text is made ASCII
    EXPECT_EQ(
        headerWith({{false, "LASF_Projection", 34735, geoKeys({1, 1, 0, 1, 2048, 0, 1, 4326})}}).crsEpsg,
        4326);
    // User-defined (32767), stored elsewhere, or not there although counted: unknown.
    for (const auto& numbers : {std::vector<std::uint16_t>{1, 1, 0, 1, 3072, 0, 1, 32767},
                                {1, 1, 0, 1, 3072, 34736, 1, 5},
                                {1, 1, 0, 60000, 1024, 0, 1, 1},
                                {1, 1}})
        EXPECT_EQ(headerWith({{false, "LASF_Projection", 34735, geoKeys(numbers)}}).crsEpsg, std::nullopt);
    EXPECT_EQ(headerWith({{true, "another", 2112, "x"}, {true, "LASF_Projection", 2112, "PROJCS[]"}}).crsWkt,
              "PROJCS[]");
}

// Whatever the records in front of the points say of themselves, the points are read.
TEST(LasCrs, DamagedRecordsHarmNoPoint) {
    LasFile file = sample(2, 3, 1, 5);
    file.records = {{false, "LASF_Projection", 2112, "PROJCS[]"}, {false, "other", 1, "abc"}};
    const auto whole = file.bytes();
    for (std::size_t at = 227; at < 227 + 54; ++at)
        for (const int value : {0x00, 0x7f, 0xff}) {
            auto bytes = whole;
            bytes[at] = static_cast<std::byte>(value);
            const auto scan = readLas(bytes);
            ASSERT_TRUE(scan) << at;
            expectPoints(file, scan->first);
        }
    auto bytes = whole;
    put(bytes, 100, std::uint32_t(0xffffffff));
    EXPECT_TRUE(readLas(bytes));
}

// As several processes read one file. Right because the parts, one behind the other, are the points that were written.
TEST(LasSource, PartsFollowEachOther) {
    const LasFile file = sample(2, 2, 257);
    const auto bytes = file.bytes();
    EXPECT_FALSE((*open(bytes, false))->hasParts()) << "a pipe cannot be gone back in";
    PointBatch all;
    for (const auto& [first, count] : {std::pair(0, 37), {37, 0}, {37, 62}, {99, 1}, {100, 5}, {90, 0}}) {
        const auto source = open(bytes);
        ASSERT_TRUE(source);
        ASSERT_TRUE((*source)->hasParts());
        (*source)->readPart(std::uint64_t(first), std::uint64_t(count));
        PointBatch batch;
        std::size_t read = 0;
        for (auto more = (*source)->read(batch); more && *more; more = (*source)->read(batch)) {
            read += batch.size();
            append(all, batch);
        }
        EXPECT_EQ(read, first < 100 ? std::size_t(count) : 0U) << first;
    }
    expectPoints(file, all);
}

}  // namespace scancast::test
