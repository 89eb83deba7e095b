// What a LAS record holds beside the sample. Oracle: the numbers are written at the places that the tables of
// ASPRS LAS 1.4 R15 give, here and apart from the reader's own tables.
#include <gmock/gmock.h>

#include <map>

#include "renderer/cloud/import/las/las_source.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/import/las_bytes.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::ElementsAre;

namespace {

using Values = std::vector<double>;

std::size_t widthOf(ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
        case ColumnType::Uint8:
            return 1;
        case ColumnType::Int16:
        case ColumnType::Uint16:
            return 2;
        case ColumnType::Int32:
        case ColumnType::Uint32:
        case ColumnType::Float32:
            return 4;
        default:
            return 8;
    }
}

template <class T>
double as(const std::byte* at) {
    T value{};
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

double valueAt(const std::byte* at, const Column& column) {
    const double stored = [&] {
        switch (column.type) {
            case ColumnType::Int8:
                return as<std::int8_t>(at);
            case ColumnType::Uint8:
                return as<std::uint8_t>(at);
            case ColumnType::Int16:
                return as<std::int16_t>(at);
            case ColumnType::Uint16:
                return as<std::uint16_t>(at);
            case ColumnType::Int32:
                return as<std::int32_t>(at);
            case ColumnType::Uint32:
                return as<std::uint32_t>(at);
            case ColumnType::Int64:
                return as<std::int64_t>(at);
            case ColumnType::Uint64:
                return as<std::uint64_t>(at);
            case ColumnType::Float32:
                return as<float>(at);
            case ColumnType::Float64:
                return as<double>(at);
        }
        return 0.0;
    }();
    return column.offset + column.scale * stored;
}

/// The scaled values of every column of a batch.
std::map<std::string, Values> valuesOf(const ScanHeader& header, const PointBatch& batch) {
    std::map<std::string, Values> result;
    std::size_t stride = 0, at = 0;
    for (const auto& column : header.columns) stride += widthOf(column.type);
    EXPECT_EQ(batch.rows.size(), stride * batch.size());
    for (const auto& column : header.columns) {
        for (std::size_t i = 0; (i + 1) * stride <= batch.rows.size(); ++i)
            result[column.name].push_back(valueAt(batch.rows.data() + i * stride + at, column));
        at += widthOf(column.type);
    }
    return result;
}

struct Kept {
    ScanHeader header;
    std::map<std::string, Values> values;
};

Kept readKept(const std::vector<std::byte>& bytes, bool seekable = true) {
    auto source = LasSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "a.las", true);
    EXPECT_TRUE(source) << source.error().message;
    if (!source) return {};
    PointBatch batch;
    const auto more = (*source)->read(batch);
    EXPECT_TRUE(more && *more);
    return {(*source)->header(), valuesOf((*source)->header(), batch)};
}

LasFile fileOf(int minor, int format, std::uint16_t extraBytes = 0) {
    LasFile file;
    file.minor = minor;
    file.format = format;
    file.extraBytes = extraBytes;
    file.points.resize(2);
    return file;
}

/// Where record i begins.
std::size_t record(const std::vector<std::byte>& bytes, std::size_t i) {
    return static_cast<std::size_t>(as<std::uint32_t>(bytes.data() + 96)) +
           i * static_cast<std::size_t>(as<std::uint16_t>(bytes.data() + 105));
}

struct Described {
    std::uint8_t type = 0, options = 0;
    std::string name;
    std::array<double, 3> scale{}, offset{};
    std::string description = {};
};

/// Table 24: one 192-byte descriptor each.
LasRecord extraBytesRecord(const std::vector<Described>& all) {
    std::vector<std::byte> bytes(192 * all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto at = 192 * i;
        put(bytes, at + 2, all[i].type);
        put(bytes, at + 3, all[i].options);
        putText(bytes, at + 4, all[i].name);
        for (std::size_t k = 0; k < 3; ++k) {
            put(bytes, at + 112 + 8 * k, all[i].scale[k]);
            put(bytes, at + 136 + 8 * k, all[i].offset[k]);
        }
        putText(bytes, at + 160, all[i].description);
    }
    return {false, "LASF_Spec", 4, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
}

ImportOptions keeping() {
    ImportOptions options;
    options.keepAttributes = true;
    return options;
}

std::vector<std::string> names(const ScanHeader& header) {
    std::vector<std::string> result;
    for (const auto& column : header.columns) result.push_back(column.name);
    return result;
}

}  // namespace

TEST(LasColumns, OldPointFormats) {
    for (const int format : {0, 1, 2, 3, 4, 5}) {
        auto bytes = fileOf(format >= 4 ? 3 : 2, format).bytes();
        const auto at = record(bytes, 1);
        put(bytes, record(bytes, 0) + 14, std::uint32_t(0));
        put(bytes, record(bytes, 0) + 18, std::uint16_t(0));
        // return 5 of 6, direction 1, edge 0 | class 2, synthetic and withheld | angle -12 | user 200 |
        // source
        put(bytes, at + 14, std::uint8_t(5 | (6 << 3) | (1 << 6)));
        put(bytes, at + 15, std::uint8_t(2 | (5 << 5)));
        put(bytes, at + 16, std::int8_t(-12));
        put(bytes, at + 17, std::uint8_t(200));
        put(bytes, at + 18, std::uint16_t(60000));
        const bool timed = format != 0 && format != 2;
        if (timed) put(bytes, at + 20, 123456.789);
        const auto kept = readKept(bytes);
        EXPECT_THAT(kept.values.at("return_number"), ElementsAre(0, 5));
        EXPECT_THAT(kept.values.at("number_of_returns"), ElementsAre(0, 6));
        EXPECT_THAT(kept.values.at("scan_direction_flag"), ElementsAre(0, 1));
        EXPECT_THAT(kept.values.at("edge_of_flight_line"), ElementsAre(0, 0));
        EXPECT_THAT(kept.values.at("class_flags"), ElementsAre(0, 5));
        EXPECT_THAT(kept.values.at("scan_angle"), ElementsAre(0, -12));
        EXPECT_THAT(kept.values.at("user_data"), ElementsAre(0, 200));
        EXPECT_THAT(kept.values.at("point_source_id"), ElementsAre(0, 60000));
        EXPECT_EQ(kept.values.count("gps_time"), timed ? 1U : 0U);
        if (timed) {
            EXPECT_EQ(kept.values.at("gps_time")[1], 123456.789);
        }
    }
}

TEST(LasColumns, NewPointFormats) {
    for (const int format : {6, 7, 8, 9, 10}) {
        auto bytes = fileOf(4, format).bytes();
        put(bytes, 6, std::uint16_t(1));
        const auto at = record(bytes, 1);
        // return 9 of 15 | key point and overlap, channel 2, direction 0, edge 1 | class | user | angle |
        // source
        put(bytes, at + 14, std::uint8_t(9 | (15 << 4)));
        put(bytes, at + 15, std::uint8_t(10 | (2 << 4) | (1 << 7)));
        put(bytes, at + 17, std::uint8_t(7));
        put(bytes, at + 18, std::int16_t(-30000));
        put(bytes, at + 20, std::uint16_t(65535));
        put(bytes, at + 22, -98765.4321);
        const bool infrared = format == 8 || format == 10;
        if (infrared) put(bytes, at + 36, std::uint16_t(54321));
        const auto kept = readKept(bytes);
        EXPECT_EQ(kept.values.at("return_number")[1], 9);
        EXPECT_EQ(kept.values.at("number_of_returns")[1], 15);
        EXPECT_EQ(kept.values.at("class_flags")[1], 10);
        EXPECT_EQ(kept.values.at("scanner_channel")[1], 2);
        EXPECT_EQ(kept.values.at("scan_direction_flag")[1], 0);
        EXPECT_EQ(kept.values.at("edge_of_flight_line")[1], 1);
        EXPECT_EQ(kept.values.at("user_data")[1], 7);
        EXPECT_DOUBLE_EQ(kept.values.at("scan_angle")[1], -180);
        EXPECT_EQ(kept.values.at("point_source_id")[1], 65535);
        EXPECT_EQ(kept.values.at("gps_time")[1], -98765.4321);
        EXPECT_EQ(kept.values.count("nir"), infrared ? 1U : 0U);
        if (infrared) {
            EXPECT_EQ(kept.values.at("nir")[1], 54321);
        }
        for (const auto& column : kept.header.columns) {
            if (column.name == "gps_time") {
                EXPECT_THAT(column.description, ::testing::HasSubstr("adjusted"));
            }
        }
    }
}

// LAS 1.5, Public Header Block: with the bits 1 and 64 of the global encoding, times are less 1e6 × what stands at byte 391.
TEST(LasColumns, TimesSayWhatWasTakenFromThem) {
    const auto meaning = [](int minor, std::uint16_t encoding) {
        auto bytes = fileOf(minor, 6).bytes();
        put(bytes, 6, encoding);
        if (minor >= 5) put(bytes, 391, std::uint16_t(1500));
        for (const auto& column : readKept(bytes).header.columns)
            if (column.name == "gps_time") return column.description;
        return std::string();
    };
    for (const int minor : {4, 5}) {
        EXPECT_EQ(meaning(minor, 0), "seconds of the GPS week");
        EXPECT_EQ(meaning(minor, 64), "seconds of the GPS week");
        EXPECT_EQ(meaning(minor, 1), "adjusted standard GPS time: seconds since 1980-01-06, less 1e9");
    }
    EXPECT_EQ(meaning(4, 65), meaning(4, 1));
    EXPECT_EQ(meaning(5, 65), "offset GPS time: seconds since 1980-01-06, less 1500e6");
}

TEST(LasColumns, ExtraBytesOfEveryType) {
    for (const bool extended : {false, true}) {
        auto file = fileOf(4, 6, 1 + 1 + 2 + 2 + 4 + 4 + 8 + 8 + 4 + 8 + 6 + 2 + 3);
        file.records = {extraBytesRecord({{1, 0, "a", {}, {}, "first"},
                                          {2, 0, "b"},
                                          {3, 8, "c", {0.5}, {9}},
                                          {4, 24, "d", {2}, {-100}},
                                          {5, 16, "e", {7}, {1e6}},
                                          {6, 0, "f"},
                                          {7, 0, "user_data"},
                                          {8, 0, ""},
                                          {9, 0, "h"},
                                          {10, 0, "i"},
                                          {23, 8, "j", {1, 10, 100}},
                                          {0, 2, "k"}})};
        file.records[0].extended = extended;
        auto bytes = file.bytes();
        auto at = record(bytes, 1) + 30;
        const auto next = [&](auto value) {
            put(bytes, at, value);
            at += sizeof value;
        };
        next(std::uint8_t(255));
        next(std::int8_t(-128));
        next(std::uint16_t(65535));
        next(std::int16_t(-32768));
        next(std::uint32_t(4294967295U));
        next(std::int32_t(-2147483647));
        next(std::uint64_t(1) << 60);
        next(std::int64_t(-7));
        next(0.25F);
        next(1e-300);
        for (const int i : {1, 2, 3}) next(static_cast<std::uint16_t>(i));
        for (const int i : {11, 12, 13, 14, 15}) next(static_cast<std::uint8_t>(i));
        const auto kept = readKept(bytes);
        const auto value = [&](const char* name) { return kept.values.at(name).at(1); };
        EXPECT_EQ(value("a"), 255);
        EXPECT_EQ(value("b"), -128);
        EXPECT_EQ(value("c"), 65535 * 0.5);
        EXPECT_EQ(value("d"), -32768 * 2 - 100);
        EXPECT_EQ(value("e"), 4294967295.0 + 1e6);
        EXPECT_EQ(value("f"), -2147483647);
        EXPECT_EQ(value("user_data_2"), 0x1p60);  // the standard's own user_data comes first
        EXPECT_EQ(value("extra_0"), -7);
        EXPECT_EQ(value("h"), 0.25);
        EXPECT_EQ(value("i"), 1e-300);
        EXPECT_EQ(value("j_0"), 1);
        EXPECT_EQ(value("j_1"), 20);
        EXPECT_EQ(value("j_2"), 300);
        EXPECT_EQ(value("k_0"), 11);
        EXPECT_EQ(value("k_1"), 12);
        EXPECT_EQ(value("extra_1"), 13);
        EXPECT_EQ(value("extra_3"), 15);
        for (const auto& column : kept.header.columns) {
            if (column.name == "a") {
                EXPECT_EQ(column.description, "first");
            }
        }
    }
}

// Descriptions that promise more than there is, unknown types, halves of descriptors: bytes that they leave.
TEST(LasColumns, WrongDescriptionsCostNothing) {
    for (const std::vector<Described>& wrong : {std::vector<Described>{{10, 0, "too long"}},
                                                {{99, 0, "unknown"}},
                                                {{0, 200, "too many"}},
                                                {{30, 0, "three doubles"}}}) {
        auto file = fileOf(2, 0, 4);
        file.records = {extraBytesRecord(wrong)};
        const auto kept = readKept(file.bytes());
        const auto found = names(kept.header);
        EXPECT_THAT(std::vector(found.end() - 4, found.end()),
                    ElementsAre("extra_0", "extra_1", "extra_2", "extra_3"));
        EXPECT_THAT(kept.values.at("extra_3"), ElementsAre(0xee, 0xee));
    }
    auto file = fileOf(2, 0, 2);
    file.records = {extraBytesRecord({{1, 8, "a", {std::numeric_limits<double>::infinity()}}, {1, 8, "b"}})};
    file.records[0].content.resize(192 + 100);
    const auto found = names(readKept(file.bytes()).header);
    EXPECT_THAT(std::vector(found.end() - 2, found.end()), ElementsAre("a", "extra_0"));
    EXPECT_EQ(readKept(file.bytes()).header.columns[found.size() - 2].scale, 1);
}

TEST(LasColumns, NumberOfColumnsIsBounded) {
    const auto kept = readKept(fileOf(2, 0, 60000).bytes());
    EXPECT_EQ(kept.header.columns.size(), 8 + mostExtraColumns);
}

TEST(LasColumns, OnlyOnRequestAndTheSameOnAPipe) {
    auto file = fileOf(2, 3, 3);
    file.records = {extraBytesRecord({{3, 0, "a"}})};
    const auto bytes = file.bytes();
    auto plain = LasSource::create(std::make_unique<MemoryByteSource>(bytes), "a.las");
    ASSERT_TRUE(plain);
    EXPECT_TRUE((*plain)->header().columns.empty());
    PointBatch batch;
    EXPECT_TRUE((*plain)->read(batch));
    EXPECT_TRUE(batch.rows.empty());
    EXPECT_EQ(readKept(bytes, true).values, readKept(bytes, false).values);
}

// Points without a place are dropped with their rows.
TEST(LasColumns, RowsFollowThePointsThatStay) {
    LasFile file = fileOf(2, 0);
    file.points.resize(10);
    file.scale = 1e300;
    file.offset = 0;
    for (auto& p : file.points) p.x = p.y = p.z = 1;
    file.points[0].y = file.points[4].y = 2000000000;
    auto bytes = file.bytes();
    for (std::size_t i = 0; i < 10; ++i) put(bytes, record(bytes, i) + 17, static_cast<std::uint8_t>(i));
    EXPECT_THAT(readKept(bytes).values.at("user_data"), ElementsAre(1, 2, 3, 5, 6, 7, 8, 9));
}

// This file's extra bytes repeat what its records say: colour, return number and number of returns,
// intensity, whole seconds of the time.
TEST(LasColumns, RealExtraBytes) {
    REQUIRE_TEST_DATA("las/extrabytes.las");
    auto source = openScan(testData("las/extrabytes.las"), keeping());
    ASSERT_TRUE(source) << source.error().message;
    PointBatch batch;
    ASSERT_TRUE((*source)->read(batch).value());
    ASSERT_EQ(batch.size(), 1065U);
    const auto kept = valuesOf((*source)->header(), batch);
    const auto all = names((*source)->header());
    EXPECT_THAT(std::vector(all.begin() + 9, all.end()),
                ElementsAre("Colors_0", "Colors_1", "Colors_2", "Reserved_0", "Reserved_1", "Reserved_2",
                            "Reserved_3", "Reserved_4", "Reserved_5", "Reserved_6", "Flags_0", "Flags_1",
                            "Intensity", "Time"));
    for (std::size_t i = 0; i < batch.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_EQ(kept.at("Colors_" + std::to_string(k))[i], batch.color[i][k]);
        ASSERT_EQ(kept.at("Intensity")[i], batch.intensity[i]);
        ASSERT_EQ(kept.at("Flags_0")[i], kept.at("return_number")[i]);
        ASSERT_EQ(kept.at("Flags_1")[i], kept.at("number_of_returns")[i]);
        ASSERT_EQ(kept.at("Time")[i], std::floor(kept.at("gps_time")[i]));
    }
}

TEST(LasColumns, EveryRealFileKeepsThem) {
    for (const char* name : {"las/autzen_trim.las", "las/las10-pdrf0.las", "las/pdrf10-1.4.las",
                             "las/pdrf5-1.3.las", "bad/malformed_extrabytes.las", "bad/gps-time-nan.las"}) {
        REQUIRE_TEST_DATA(name);
        auto source = openScan(testData(name), keeping());
        ASSERT_TRUE(source) << source.error().message;
        PointBatch batch;
        ASSERT_TRUE((*source)->read(batch).value());
        const auto kept = valuesOf((*source)->header(), batch);
        const bool old = (*source)->header().format.find("format 10") == std::string::npos;
        for (std::size_t i = 0; i < batch.size(); ++i) {
            ASSERT_LE(kept.at("return_number")[i], old ? 7 : 15);
            ASSERT_LE(std::abs(kept.at("scan_angle")[i]), old ? 128 : 197);
        }
    }
}

}  // namespace scancast::test
