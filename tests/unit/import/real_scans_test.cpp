// Every real scan gives the number of points, bounds, columns and ranges that an independent
// program found in it (SOURCES.md, beside the scans): that program shares no code with these readers.
#include <gmock/gmock.h>

#include <optional>
#include <sstream>

#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/import/real_scans.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

namespace {

/// Half a unit of the last printed digit, and a little for the rounding of the unit's own.
double tolerance(const std::string& printed) {
    const auto exponent = printed.find('e');
    const auto mantissa = printed.substr(0, exponent);
    const auto point = mantissa.find('.');
    const double unit = point == std::string::npos ? 1 : std::pow(10.0, -double(mantissa.size() - point - 1));
    const double scale =
        exponent == std::string::npos ? 1 : std::pow(10.0, std::stod(printed.substr(exponent + 1)));
    return 0.51 * unit * scale;
}

/// The numbers of "a x b x c; min d e f".
std::vector<std::string> numbers(const char* box) {
    std::vector<std::string> result;
    std::istringstream words(box);
    for (std::string word; words >> word;) {
        if (word == "x" || word == "min") continue;
        if (word.back() == ';') word.pop_back();
        result.push_back(word);
    }
    return result;
}

class RealScans : public ::testing::TestWithParam<RealScan> {};

ImportOptions realScanOptions() {
    return {.importerDirectory = SCANCAST_BIN_DIR};
}

void expectSamePoints(PointSource& one, PointSource& other) {
    const auto a = test::readAll(one).value();
    const auto b = test::readAll(other).value();
    EXPECT_GT(a.size(), 0U);
    EXPECT_TRUE(a.position == b.position);
    EXPECT_TRUE(a.color == b.color);
    EXPECT_TRUE(a.intensity == b.intensity);
    EXPECT_TRUE(a.classification == b.classification);
    EXPECT_TRUE(a.rows == b.rows);
}

}  // namespace

TEST(LazGlance, IsOfPointsFromAllOverTheScan) {
    const char* const file = "laz/strand-statue-1m.laz";
    REQUIRE_TEST_DATA(file);
    auto source = openScan(testData(file), realScanOptions()).value();
    const PointBatch glance = source->glance().value();
    const PointBatch whole = test::readAll(*source).value();
    // The first 200 of each of its chunks, where they are in the file.
    ASSERT_GE(glance.size(), 2'000U);
    ASSERT_LE(glance.size(), 65'536U);
    std::size_t at = 0;
    for (std::size_t i = 0; i < glance.size(); ++i, ++at) {
        while (at < whole.size() && whole.position[at] != glance.position[i]) ++at;
        ASSERT_LT(at, whole.size()) << i;
        ASSERT_TRUE(glance.color[i] == whole.color[at]);
        ASSERT_EQ(glance.intensity[i], whole.intensity[at]);
    }
    EXPECT_GT(at, whole.size() * 9 / 10);
}

TEST_P(RealScans, GiveWhatIsInThem) {
    const auto& expected = GetParam();
    REQUIRE_TEST_DATA(expected.file);
    auto source = openScan(testData(expected.file), realScanOptions());
    ASSERT_TRUE(source) << source.error().message;
    const auto& header = (*source)->header();
    EXPECT_EQ(header.format, expected.format);
    // A text does not say how many points it has: a count is that of one scan of several. Nor do these octrees: their sum
    // is that of their nodes.
    const bool counted = std::string_view(expected.file).starts_with("text/") ||
                         std::string_view(expected.format).starts_with("Potree 1");
    EXPECT_EQ(header.points, counted ? std::nullopt : std::optional(expected.points));
    const std::string columns = expected.columns;
    const auto has = [&](char c) { return columns.find(c) != std::string::npos; };
    EXPECT_EQ(header.attributes, (Attributes{has('c'), has('i'), has('k'), has('n'), has('r')}));

    const auto summary = summarize(**source);
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->points, expected.points - expected.dropped);
    EXPECT_EQ((*source)->droppedPoints(), expected.dropped);
    const auto box = numbers(expected.box);
    ASSERT_EQ(box.size(), 6U);
    for (int i = 0; i < 3; ++i) {
        const auto& size = box[static_cast<std::size_t>(i)];
        const auto& min = box[static_cast<std::size_t>(i) + 3];
        EXPECT_NEAR(summary->max[i] - summary->min[i], std::stod(size), tolerance(size));
        EXPECT_NEAR(summary->min[i], std::stod(min), tolerance(min));
    }
    if (expected.intensity[0] >= 0) {
        EXPECT_EQ(summary->intensity, expected.intensity);
    }
    if (*expected.classes != '\0') {
        std::set<int> classes;
        std::istringstream list(expected.classes);
        for (std::string word; std::getline(list, word, ',');) classes.insert(std::stoi(word));
        // SOURCES.md names at most the 14 lowest classes of a file.
        constexpr std::size_t mostNamed = 14;
        auto found = summary->classes;
        while (classes.size() == mostNamed && found.size() > mostNamed) found.erase(std::prev(found.end()));
        EXPECT_EQ(found, classes);
    }
    // Colours above 255 are 16-bit ones, of which the high byte is kept.
    if (expected.rgbMax >= 0) {
        EXPECT_EQ(summary->colorMax, expected.rgbMax > 255 ? expected.rgbMax >> 8 : expected.rgbMax);
    }
    if (has('n')) {
        EXPECT_EQ(summary->normals, summary->points);
    }
}

/// Decoding the largest takes as long as all the others together, and no other way through the code.
std::vector<RealScan> scansOf(bool large) {
    std::vector<RealScan> some;
    for (const RealScan& scan : realScans)
        if ((scan.points > 5'000'000) == large) some.push_back(scan);
    return some;
}
INSTANTIATE_TEST_SUITE_P(All, RealScans, ::testing::ValuesIn(scansOf(false)), fileAsTestName<RealScan>);
INSTANTIATE_TEST_SUITE_P(Slow, RealScans, ::testing::ValuesIn(scansOf(true)), fileAsTestName<RealScan>);

// The same survey in three containers: columns that went different ways must meet.
TEST(RealScansAgree, AutzenAsLasAndAsPcd) {
    REQUIRE_TEST_DATA("las/las12-pdrf2-color.las");
    REQUIRE_TEST_DATA("pcd/autzen-utm.pcd");
    const auto las = summarizeOpened(openScan(testData("las/las12-pdrf2-color.las"), realScanOptions()));
    const auto pcd = summarizeOpened(openScan(testData("pcd/autzen-utm.pcd"), realScanOptions()));
    ASSERT_TRUE(las && pcd);
    EXPECT_EQ(las->first.intensity, pcd->first.intensity);
    EXPECT_EQ(las->first.classification, pcd->first.classification);
    EXPECT_EQ(las->first.color, pcd->first.color);
    for (std::size_t i = 0; i < las->first.size(); ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(las->first.position[i][k], pcd->first.position[i][k], 1e-6);
}

// Compression loses nothing: every column of every point, and what the header says of the grid.
TEST(RealScansAgree, LasAndLaz) {
    for (const auto& [laz, las] : {std::pair("laz/autzen_trim.laz", "las/autzen_trim.las"),
                                   {"laz/pdrf0-compressor1-pointwise.laz", "las/las10-pdrf0.las"},
                                   {"laz/pdrf2-color.laz", "las/las12-pdrf2-color.las"},
                                   {"laz/pdrf5-1.3.laz", "las/pdrf5-1.3.las"},
                                   {"laz/pdrf9-1.4.laz", "las/pdrf9-1.4.las"},
                                   {"laz/pdrf8-1.4.laz", "las/pdrf8-1.4.las"}}) {
        REQUIRE_TEST_DATA(laz);
        REQUIRE_TEST_DATA(las);
        auto keep = realScanOptions();
        keep.keepAttributes = true;
        auto one = openScan(testData(laz), keep);
        auto other = openScan(testData(las), keep);
        ASSERT_TRUE(one && other);
        EXPECT_FALSE((*one)->header().columns.empty());
        EXPECT_EQ((*one)->header().columns, (*other)->header().columns) << laz;
        EXPECT_EQ((*one)->header().gridStep, (*other)->header().gridStep) << laz;
        EXPECT_EQ((*one)->header().gridOrigin, (*other)->header().gridOrigin) << laz;
        expectSamePoints(**one, **other);
    }
}

TEST(RealScansAgree, GuanyinInBothByteOrders) {
    REQUIRE_TEST_DATA("ply/guanyin-statue.ply");
    REQUIRE_TEST_DATA("ply/guanyin-half-big-endian.ply");
    const auto whole = summarizeOpened(openScan(testData("ply/guanyin-statue.ply"), realScanOptions()));
    const auto half =
        summarizeOpened(openScan(testData("ply/guanyin-half-big-endian.ply"), realScanOptions()));
    ASSERT_TRUE(whole && half);
    for (std::size_t i = 0; 2 * i < whole->first.size(); ++i) {
        ASSERT_EQ(whole->first.position[2 * i], half->first.position[i]);
        ASSERT_EQ(whole->first.color[2 * i], half->first.color[i]);
    }
}

// 4-byte floats cannot hold these northings to better than 0.25 m; the text gives centimetres.
TEST(RealScansAgree, TextCoordinatesKeepTheirDigits) {
    REQUIRE_TEST_DATA("pcd/utm17_space.pcd");
    for (const char* file : {"pcd/utm17_space.pcd", "pcd/utm17_comma.pcd"}) {
        const auto scan = summarizeOpened(openScan(testData(file), realScanOptions()));
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_EQ(scan->first.position[0], glm::dvec3(289814.15, 4320978.61, 170.76));
        EXPECT_EQ(scan->first.position[9], glm::dvec3(289818.50, 4320980.59, 170.58));
    }
}

TEST(RealScansAgree, CoordinateReferenceSystems) {
    struct Crs {
        const char* file;
        std::optional<int> epsg;
        const char* wkt;  ///< a part of it; empty = none
    };
    for (const auto& [file, epsg, wkt] :
         {Crs{"las/las10-pdrf0.las", 32128, ""}, Crs{"las/certainty3d-feet.las", 2229, ""},
          Crs{"las/las14-pdrf6-wkt.las", 32104, "Foot_US"}, Crs{"las/las14-pdrf7-color.las", 4326, ""},
          Crs{"las/lonlat-pdrf0.las", 4326, ""}, Crs{"las/permutation-1.2_3.las", 26915, ""},
          Crs{"las/las14-pdrf6.las", 2903, "US survey foot"},
          // Its parts have numbers, the whole has none.
          Crs{"las/autzen_trim.las", std::nullopt, "NAD_1983_HARN"},
          Crs{"las/warsaw_small.las", std::nullopt, ""}, Crs{"las/sample_c.las", std::nullopt, ""}}) {
        REQUIRE_TEST_DATA(file);
        const auto source = openScan(testData(file), realScanOptions());
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->header().crsEpsg, epsg) << file;
        EXPECT_THAT((*source)->header().crsWkt, ::testing::HasSubstr(wkt)) << file;
    }
}

}  // namespace scancast::test
