// Colours, intensities, normals, classes and further columns: on which scale, from which limits, and what is not valid.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

/// Points along x, whose further fields have the numbers given, record by record.
E57Scan scanWith(std::vector<E57Field> fields, std::vector<std::vector<double>> values,
                 std::string xml = {}) {
    E57Scan scan;
    scan.fields = {E57Field::real("cartesianX"), E57Field::integer("cartesianY", 0, 0),
                   E57Field::integer("cartesianZ", 0, 0)};
    scan.fields.insert(scan.fields.end(), fields.begin(), fields.end());
    scan.records = values.size();
    scan.xml = std::move(xml);
    scan.real = [values](std::uint64_t record, std::size_t field) {
        return field == 0 ? static_cast<double>(record) : values[record][field - 3];
    };
    scan.raw = [values](std::uint64_t record, std::size_t field) {
        return field < 3 ? 0 : static_cast<std::int64_t>(values[record][field - 3]);
    };
    return scan;
}

std::vector<std::uint16_t> intensities(const E57Field& field, std::vector<double> values,
                                       std::string xml = {}) {
    std::vector<std::vector<double>> rows;
    for (const double value : values) rows.push_back({value});
    const auto result = imported(e57File({scanWith({field}, rows, std::move(xml))}));
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->points.intensity : std::vector<std::uint16_t>();
}

std::string limits(const std::string& what, const std::string& low, const std::string& high) {
    return "<" + what + "Limits><" + what + "Minimum>" + low + "</" + what + "Minimum><" + what + "Maximum>" +
           high + "</" + what + "Maximum></" + what + "Limits>";
}

E57Field intensityOf(std::int64_t low, std::int64_t high) {
    return E57Field::integer("intensity", low, high);
}

std::vector<std::uint8_t> reds(E57Field field, std::vector<double> values, const std::string& low = {},
                               const std::string& high = {}) {
    std::vector<E57Field> fields;
    std::vector<std::vector<double>> rows;
    std::string xml = "<colorLimits>";
    for (const std::string channel : {"colorRed", "colorGreen", "colorBlue"}) {
        field.name = channel;
        fields.push_back(field);
        if (!low.empty())
            xml += "<" + channel + "Minimum>" + low + "</" + channel + "Minimum><" + channel + "Maximum>" +
                   high + "</" + channel + "Maximum>";
    }
    for (const double value : values) rows.push_back({value, 0, 0});
    const auto result = imported(e57File({scanWith(fields, rows, xml + "</colorLimits>")}));
    EXPECT_TRUE(result) << result.error().message;
    std::vector<std::uint8_t> found;
    if (result)
        for (const auto& color : result->points.color) found.push_back(color[0]);
    return found;
}

template <class T>
T stored(const PointBatch& points, std::size_t row, std::size_t rowBytes, std::size_t at) {
    T value;
    std::memcpy(&value, points.rows.data() + row * rowBytes + at, sizeof value);
    return value;
}

}  // namespace

TEST(E57Intensity, IsStretchedFromItsLimits) {
    EXPECT_THAT(intensities(intensityOf(0, 2047), {0, 1, 1023, 2047}, limits("intensity", "0", "2047")),
                ElementsAre(0, 32, 32751, 65535));
    EXPECT_THAT(
        intensities(E57Field::single("intensity"), {0, 0.25, 1, 2, -1}, limits("intensity", "0", "1")),
        ElementsAre(0, 16384, 65535, 65535, 0));
    // Limits as the scaled integers that they are.
    const std::string scaled =
        R"(<intensityLimits><intensityMinimum type="ScaledInteger" scale="0.1">-666</intensityMinimum>)"
        R"(<intensityMaximum type="ScaledInteger" scale="0.1">666</intensityMaximum></intensityLimits>)";
    EXPECT_THAT(intensities(E57Field::scaled("intensity", -666, 666, 0.1), {-666, 0, 666}, scaled),
                ElementsAre(0, 32768, 65535));
}

TEST(E57Intensity, WithoutLimitsIsWhatItsFieldCanHold) {
    EXPECT_THAT(intensities(intensityOf(0, 255), {0, 1, 255}), ElementsAre(0, 257, 65535));
    EXPECT_THAT(intensities(intensityOf(0, 65535), {0, 1234, 65535}), ElementsAre(0, 1234, 65535));
    EXPECT_THAT(intensities(intensityOf(-2048, 2047), {-2048, 2047}), ElementsAre(0, 65535));
    // Limits without a width are none: some writers put zeros.
    EXPECT_THAT(intensities(intensityOf(0, 255), {0, 1, 255}, limits("intensity", "0", "0")),
                ElementsAre(0, 257, 65535));
}

TEST(E57Intensity, ThatNobodyTellsOfIsMeasured) {
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    EXPECT_THAT(intensities(E57Field::single("intensity"), {0, 0.5, 1}), ElementsAre(0, 32768, 65535));
    EXPECT_THAT(intensities(E57Field::real("intensity"), {0, 2, 255}), ElementsAre(0, 514, 65535));
    EXPECT_THAT(intensities(E57Field::real("intensity"), {0, 2, 4096}), ElementsAre(0, 2, 4096));
    EXPECT_THAT(intensities(E57Field::real("intensity"), {-10, 0, 10}), ElementsAre(0, 32768, 65535));
    EXPECT_THAT(intensities(intensityOf(0, most), {0, 1, 900}), ElementsAre(0, 1, 900));
    EXPECT_THAT(intensities(E57Field::single("intensity"), {std::nan(""), 0.5, 1}),
                ElementsAre(0, 32768, 65535));
    EXPECT_THAT(intensities(E57Field::single("intensity"), {1}), ElementsAre(65535));
}

TEST(E57Intensity, OfSeveralScansIsMeasuredOverAll) {
    const auto one = scanWith({E57Field::single("intensity")}, {{0.5}});
    const auto other = scanWith({E57Field::single("intensity")}, {{100}});
    EXPECT_THAT(imported(e57File({one, other}))->points.intensity, ElementsAre(129, 25700));
}

TEST(E57Intensity, ThatIsNotValidIsZeroAndCounted) {
    const auto scan = scanWith({intensityOf(0, 255), E57Field::integer("isIntensityInvalid", 0, 1)},
                               {{10, 0}, {20, 1}, {30, 0}});
    const auto result = imported(e57File({scan})).value();
    EXPECT_THAT(result.points.intensity, ElementsAre(2570, 0, 7710));
    EXPECT_THAT(result.notes,
                ElementsAre("1 point with an intensity that is marked as invalid in the file, 0 here"));
}

TEST(E57Colors, AreStretchedFromTheirLimits) {
    const auto byte = E57Field::integer({}, 0, 255);
    EXPECT_THAT(reds(byte, {0, 1, 254, 255}, "0", "255"), ElementsAre(0, 1, 254, 255));
    EXPECT_THAT(reds(byte, {0, 1, 254, 255}), ElementsAre(0, 1, 254, 255));
    EXPECT_THAT(reds(E57Field::integer({}, 0, 1023), {0, 4, 1023}, "0", "1023"), ElementsAre(0, 1, 255));
    EXPECT_THAT(reds(E57Field::single({}), {0, 0.5, 1, 1.5}, "0", "1"), ElementsAre(0, 128, 255, 255));
    EXPECT_THAT(reds(E57Field::scaled({}, 0, 1000, 0.001), {0, 500, 1000}, "0", "1"),
                ElementsAre(0, 128, 255));
    EXPECT_THAT(reds(byte, {0, 1, 255}, "0", "0"), ElementsAre(0, 1, 255));
}

TEST(E57Colors, OfSixteenBitsAreCut) {
    const auto wide = E57Field::integer({}, 0, 65535);
    EXPECT_THAT(reds(wide, {0, 255, 256, 65280, 65535}, "0", "65535"), ElementsAre(0, 0, 1, 255, 255));
    // Without limits the numbers tell whether eight bits were put there.
    EXPECT_THAT(reds(wide, {0, 100, 65280}), ElementsAre(0, 0, 255));
    EXPECT_THAT(reds(wide, {0, 100, 255}), ElementsAre(0, 100, 255));
}

TEST(E57Colors, ThatNobodyTellsOfAreMeasured) {
    EXPECT_THAT(reds(E57Field::single({}), {0, 0.5, 1}), ElementsAre(0, 128, 255));
    EXPECT_THAT(reds(E57Field::single({}), {0, 0.5, 200}), ElementsAre(0, 1, 200));
    EXPECT_THAT(reds(E57Field::real({}), {0, 512, 65535}), ElementsAre(0, 2, 255));
    EXPECT_THAT(reds(E57Field::real({}), {0, 1e6, 2e6}), ElementsAre(0, 128, 255));
}

TEST(E57Colors, ThatAreNotValidOrMissingAreBlackAndTold) {
    const std::vector<E57Field> colors{
        E57Field::integer("colorRed", 0, 255), E57Field::integer("colorGreen", 0, 255),
        E57Field::integer("colorBlue", 0, 255), E57Field::integer("isColorInvalid", 0, 1)};
    const auto result =
        imported(e57File({scanWith(colors, {{1, 2, 3, 0}, {4, 5, 6, 1}}), scanWith({}, {{}})})).value();
    using Color = std::array<std::uint8_t, 3>;
    EXPECT_THAT(result.points.color, ElementsAre(Color{1, 2, 3}, Color{0, 0, 0}, Color{0, 0, 0}));
    EXPECT_THAT(result.notes,
                ElementsAre(HasSubstr("2 scans"), "1 scan without colours, shown black beside the others",
                            "1 point with a colour that is marked as invalid in the file, black here"));
}

TEST(E57Normals, AreTurnedWithTheirScan) {
    const std::vector<E57Field> normals{E57Field::single("nor:normalX"), E57Field::single("nor:normalY"),
                                        E57Field::single("nor:normalZ")};
    const double half = std::sqrt(0.5);
    const auto result =
        imported(e57File({scanWith(normals, {{2, 0, 0}, {0, 0, 0}}, e57Pose(half, 0, 0, half, 0, 0, 0))}))
            .value();
    ASSERT_EQ(result.points.normal.size(), 2U);
    EXPECT_NEAR(result.points.normal[0].y, 1, 1e-6);
    EXPECT_EQ(result.points.normal[1], glm::vec3(0));
}

TEST(E57Classes, OfTheLasExtensionAreTaken) {
    const auto result =
        imported(e57File({scanWith({E57Field::integer("las:classification", 0, 31)}, {{2}, {31}})})).value();
    EXPECT_THAT(result.points.classification, ElementsAre(2, 31));
}

TEST(E57Columns, AreKeptOnRequest) {
    const std::vector<E57Field> fields{E57Field::integer("rowIndex", 0, 2047),
                                       E57Field::integer("columnIndex", -5, 511), E57Field::real("timeStamp"),
                                       E57Field::integer("x:wide", 0, 1LL << 40)};
    const std::vector<std::vector<double>> rows{{7, -5, 0.25, 1e12}, {2047, 511, 1e9 + 0.5, 3}};
    const auto file = e57File({scanWith({}, {{}}), scanWith(fields, rows)});
    EXPECT_THAT(imported(file)->header.columns, IsEmpty());
    const auto result = imported(file, {.keepAttributes = true}).value();
    std::vector<std::string> names;
    std::vector<ColumnType> types;
    for (const auto& column : result.header.columns) {
        names.push_back(column.name);
        types.push_back(column.type);
    }
    EXPECT_THAT(names, ElementsAre("scan_number", "row_index", "column_index", "time_stamp", "x:wide"));
    EXPECT_THAT(types, ElementsAre(ColumnType::Int32, ColumnType::Int32, ColumnType::Int32,
                                   ColumnType::Float64, ColumnType::Float64));
    constexpr std::size_t rowBytes = 28;
    ASSERT_EQ(result.points.rows.size(), 3 * rowBytes);
    const auto& points = result.points;
    EXPECT_EQ(stored<std::int32_t>(points, 0, rowBytes, 0), 1);
    EXPECT_EQ(stored<std::int32_t>(points, 0, rowBytes, 4), -1) << "the first scan has no rows";
    EXPECT_TRUE(std::isnan(stored<double>(points, 0, rowBytes, 12)));
    EXPECT_EQ(stored<std::int32_t>(points, 1, rowBytes, 0), 2);
    EXPECT_EQ(stored<std::int32_t>(points, 1, rowBytes, 4), 7);
    EXPECT_EQ(stored<std::int32_t>(points, 1, rowBytes, 8), -5);
    EXPECT_EQ(stored<double>(points, 2, rowBytes, 12), 1e9 + 0.5);
    EXPECT_EQ(stored<double>(points, 1, rowBytes, 20), 1e12);
}

TEST(E57Coordinates, AreCalledByTheFilesWords) {
    const std::string wkt = R"(PROJCS["ETRS89 / UTM zone 32N",AUTHORITY["EPSG","25832"]])";
    const auto scan = scanWith({}, {{}});
    const auto named =
        imported(e57File({scan}, "<coordinateMetadata><![CDATA[" + wkt + "]]></coordinateMetadata>"));
    EXPECT_EQ(named->header.crsWkt, wkt);
    EXPECT_EQ(named->header.crsEpsg, 25832);
    EXPECT_EQ(
        imported(e57File({scan}, "<coordinateMetadata> EPSG:4978\n</coordinateMetadata>"))->header.crsEpsg,
        4978);
    EXPECT_EQ(imported(e57File({scan}, "<coordinateMetadata type=\"String\"/>"))->header.crsWkt, "");
}

}  // namespace scancast::test
