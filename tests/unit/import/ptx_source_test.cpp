// PTX written here. Oracle: the transform by hand.
#include "renderer/cloud/import/text/ptx_source.hpp"

#include <gmock/gmock.h>

#include "tests/unit/import/text_scan.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

std::string head(int columns, int rows, const std::string& matrix = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n") {
    return std::to_string(columns) + "\n" + std::to_string(rows) + "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + matrix;
}

// A quarter turn about z, then off to 500,000 4,000,000 100.
const std::string turned = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n500000 4000000 100 1\n";

Expected<PointBatch> readPtx(const std::string& text, bool seekable = true) {
    auto source = PtxSource::create(bytesOf(text, seekable), "a.ptx");
    if (!source) return passOn(source);
    return readAll(**source);
}

void expectPtxError(const std::string& text, ErrorCode code, const char* reason) {
    const auto scan = readPtx(text);
    ASSERT_FALSE(scan) << text;
    EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
    EXPECT_THAT(scan.error().message, HasSubstr("a.ptx"));
    EXPECT_THAT(scan.error().message, HasSubstr(reason));
}

}  // namespace

// x turns to y: (1, 2, 3) becomes (-2, 1, 3) plus the translation, exact in doubles.
TEST(PtxSource, TransformsInDoublePrecision) {
    for (const bool seekable : {true, false}) {
        auto source =
            PtxSource::create(bytesOf(head(2, 1, turned) + "1 2 3 0.5\n0.001 0 0 1\n", seekable), "a.ptx");
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->header().scannerOrigin, glm::dvec3(500000, 4000000, 100));
        const auto points = readAll(**source);
        ASSERT_TRUE(points) << points.error().message;
        EXPECT_THAT(points->position,
                    ElementsAre(glm::dvec3(499998, 4000001, 103), glm::dvec3(500000, 4000000.001, 100)));
        EXPECT_THAT(points->intensity, ElementsAre(32768, 65535));
        EXPECT_EQ((*source)->header().scannerOrigin, glm::dvec3(500000, 4000000, 100));
    }
}

TEST(PtxSource, SeveralScansAndDirectionsWithoutEcho) {
    auto source =
        PtxSource::create(bytesOf(head(1, 3) + "0 0 0 0.5 0 0 0\n1 2 3 0.5 10 20 30\n0 0 0 0 0 0 0\n\n" +
                                  head(0, 5) + head(1, 1, turned) + "0 0 1 0.25 1 2 3\n\n"),
                          "a.ptx");
    ASSERT_TRUE(source) << source.error().message;
    const auto points = readAll(**source);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_THAT(points->position, ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(500000, 4000000, 101)));
    EXPECT_EQ(points->color[0], (std::array<std::uint8_t, 3>{10, 20, 30}));
    EXPECT_EQ((*source)->droppedPoints(), 2U);
    EXPECT_EQ((*source)->header().scannerOrigin, std::nullopt) << "two scanners: no one place";
    const auto stations = (*source)->stations();
    ASSERT_EQ(stations.size(), 3U);
    EXPECT_EQ(stations[0], (Station{.points = 1, .forwards = glm::dvec3(1, 0, 0)}));
    EXPECT_EQ(stations[1], (Station{.forwards = glm::dvec3(1, 0, 0)})) << "stood there and saw nothing";
    EXPECT_EQ(stations[2],
              (Station{.position = {500000, 4000000, 100}, .points = 1, .forwards = glm::dvec3(0, 1, 0)}));
}

TEST(PtxSource, EveryBatchSaysWhereItsScannerStood) {
    auto source = PtxSource::create(bytesOf(head(1, 2) + "1 2 3 1\n2 2 3 1\n" + head(1, 1) + "0 0 0 0\n" +
                                            head(1, 1, turned) + "0 0 1 1\n"),
                                    "a.ptx");
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE((*source)->stations().empty()) << "who has not read to the end does not know them";
    PointBatch batch;
    std::vector<std::pair<std::size_t, glm::dvec3>> seen;
    for (;;) {
        const auto more = (*source)->read(batch);
        ASSERT_TRUE(more) << more.error().message;
        if (!*more) break;
        ASSERT_TRUE(batch.scanner);
        seen.emplace_back(batch.size(), *batch.scanner);
    }
    EXPECT_EQ(batch.size(), 0U);
    EXPECT_EQ(seen,
              (std::vector<std::pair<std::size_t, glm::dvec3>>{{2, {0, 0, 0}}, {1, {500000, 4000000, 100}}}));
}

// Normals are turned to the one place from which all was seen: with two, to none of them.
TEST(PtxSource, ScannersPlaceOfOneScanOnly) {
    std::string points;
    for (int i = 0; i < 20000; ++i) points += "1.5 2.5 " + std::to_string(i) + " 0.5\n";
    const auto one = head(200, 100, turned) + points;
    for (const auto& [text, known] : {std::pair(one, true),
                                      {one + head(100, 200) + points, false},
                                      {head(1, 1, turned) + "1 2 3\n\n", true},
                                      {head(1, 1, turned) + "1 2 3\n" + head(1, 1) + "1 2 3\n", false}}) {
        const auto source = PtxSource::create(bytesOf(text), "a.ptx");
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->header().scannerOrigin.has_value(), known);
        EXPECT_TRUE(readAll(**source));
        EXPECT_EQ((*source)->header().scannerOrigin.has_value(), known);
    }
}

TEST(PtxSource, ColumnsOfAPoint) {
    for (const auto& [row, attributes] :
         {std::pair("1 2 3", Attributes{}),
          {"1 2 3 0.5", Attributes{.intensity = true}},
          {"1 2 3 9 8 7", Attributes{.color = true}},
          {"1 2 3 0.5 9 8 7", Attributes{.color = true, .intensity = true}}}) {
        auto source = PtxSource::create(bytesOf(head(1, 1) + row), "a.ptx");
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->header().attributes, attributes);
        EXPECT_TRUE(readAll(**source));
    }
    expectPtxError(head(1, 1) + "1 2 3 4 5\n", ErrorCode::Malformed, "the first point has 5 columns");
}

TEST(PtxSource, WhatCannotBeUnderstood) {
    expectPtxError(head(2, 2) + "1 2 3\n4 5 6\n", ErrorCode::Truncated,
                   "line 12: the file ends: its scan 1 promises 4 points, there are 2");
    expectPtxError(head(2, 2), ErrorCode::Truncated, "promises 4 points, there are none");
    expectPtxError(head(1, 1) + "1 2 3\n4 5 6\n", ErrorCode::Malformed,
                   "line 12: \"4 5 6\" should be the number of columns");
    expectPtxError("1\n1\n0 0 0\n", ErrorCode::Truncated,
                   "where the scanner's x axis of a scan should follow");
    expectPtxError("1\n-1\n0 0 0\n", ErrorCode::Malformed, "line 2: \"-1\" should be the number of rows");
    expectPtxError("4294967296\n1\n", ErrorCode::Malformed, "line 1");
    expectPtxError(head(1, 1, "1 0 0 0\n0 1 0 0\n0 0 1\n0 0 0 1\n") + "1 2 3\n", ErrorCode::Malformed,
                   "line 9: \"0 0 1\" should be a row of the matrix: 4 numbers");
    expectPtxError(head(1, 1, "1 0 0 0\n0 1 0 0\n0 0 1 7\n0 0 0 1\n") + "1 2 3\n", ErrorCode::Malformed,
                   "line 9: the fourth number of the matrix's row 3 must be 0");
    expectPtxError(head(1, 1, "1 0 0 0\n0 1 0 0\n0 1 0 0\n0 0 0 1\n") + "1 2 3\n", ErrorCode::Malformed,
                   "flattens all points");
    expectPtxError(head(1, 1, "1 0 0 0\n0 nan 0 0\n0 1 0 0\n0 0 0 1\n") + "1 2 3\n", ErrorCode::Malformed,
                   "line 8");
    expectPtxError(head(1, 2) + "0 0 0\n0 0 0\n", ErrorCode::Empty, "none of the 2 directions");
    expectPtxError(head(1, 2) + "1 2 3 0.5\n1 2 3\n", ErrorCode::Malformed,
                   "line 12: there are 3 columns, but 4");
    expectPtxError(head(1, 1) + "1 2 x\n", ErrorCode::Malformed, "line 11: column 3: \"x\" is not a number");
}

}  // namespace scancast::test
