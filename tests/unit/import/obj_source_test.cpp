// OBJ written here. Oracle: the numbers that were written.
#include "renderer/cloud/import/text/obj_source.hpp"

#include <gmock/gmock.h>

#include "renderer/cloud/import/scan_format.hpp"
#include "tests/unit/import/text_scan.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

struct ReadObj {
    PointBatch points;
    std::vector<std::string> notes;
    std::uint64_t dropped = 0;
};

Expected<ReadObj> readObj(const std::string& text, bool seekable = true) {
    auto source = ObjSource::create(bytesOf(text, seekable), "a.obj");
    if (!source) return passOn(source);
    auto points = readAll(**source);
    if (!points) return passOn(points);
    return ReadObj{std::move(*points), (*source)->notes(), (*source)->droppedPoints()};
}

void expectObjError(const std::string& text, ErrorCode code, const char* reason) {
    const auto scan = readObj(text);
    ASSERT_FALSE(scan) << text;
    EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
    EXPECT_THAT(scan.error().message, HasSubstr("a.obj"));
    EXPECT_THAT(scan.error().message, HasSubstr(reason));
}

ScanFormat formatOf(const std::string& text, std::string_view extension) {
    return identifyScan(std::as_bytes(std::span(text)), extension).format;
}

}  // namespace

TEST(ObjSource, ReadsVerticesAndTellsWhatIsLeftOut) {
    for (const bool seekable : {true, false}) {
        const auto scan = readObj(
            "# made by hand\nmtllib a.mtl\no thing\nv 1.5 -2 3e2\r\nv\t4 5 6 1.0\n  v 7 8 9\n\nvn 0 0 1\nvt "
            "0 1\nvt 1 1\n"
            "usemtl red\nf 1//1 2//1 3//1",
            seekable);
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_THAT(scan->points.position,
                    ElementsAre(glm::dvec3(1.5, -2, 300), glm::dvec3(4, 5, 6), glm::dvec3(7, 8, 9)));
        EXPECT_TRUE(scan->points.color.empty());
        EXPECT_THAT(scan->notes, ElementsAre(HasSubstr("left out are 1 face, 1 normal of corners, 2 texture "
                                                       "coordinates, 3 other lines")));
    }
}

TEST(ObjSource, ColoursStandBehindPositionsAndWeights) {
    const auto unit = readObj("v 1 2 3 0 0.5 1\nv 4 5 6 1.0 1 1 0\n");
    ASSERT_TRUE(unit) << unit.error().message;
    EXPECT_THAT(unit->points.color, ElementsAre(std::array<std::uint8_t, 3>{0, 128, 255},
                                                std::array<std::uint8_t, 3>{255, 255, 0}));
    EXPECT_TRUE(unit->notes.empty());
    const auto byte = readObj("v 1 2 3 0 128 255\n");
    ASSERT_TRUE(byte) << byte.error().message;
    EXPECT_THAT(byte->points.color, ElementsAre(std::array<std::uint8_t, 3>{0, 128, 255}));
    const auto mixed = readObj("v 1 2 3 0 0 1\nv 4 5 6\n");
    ASSERT_TRUE(mixed) << mixed.error().message;
    EXPECT_THAT(mixed->points.color[1], ElementsAre(255, 255, 255));
    EXPECT_THAT(mixed->notes, ElementsAre(HasSubstr("1 vertices have no colour")));
}

TEST(ObjSource, ColoursThatAreNoNumbersAreBlackAndCounted) {
    // Whatever the range of the others is: 0 to 65535, in whole numbers.
    const auto wide = readObj("v 1 2 3 nan 0 65535\nv 4 5 6 256 65535 0\nv 7 8 9 nan nan nan\nv 1 1 1\n");
    ASSERT_TRUE(wide) << wide.error().message;
    EXPECT_THAT(
        wide->points.color,
        ElementsAre(std::array<std::uint8_t, 3>{0, 0, 0}, std::array<std::uint8_t, 3>{1, 255, 0},
                    std::array<std::uint8_t, 3>{0, 0, 0}, std::array<std::uint8_t, 3>{255, 255, 255}));
    EXPECT_THAT(wide->notes,
                ElementsAre(HasSubstr("1 vertices have no colour"),
                            HasSubstr(": 2 points with a colour that is no number, black here")));
    const auto none = readObj("v 1 2 3 nan nan nan\nv 4 5 6 nan nan nan\n");
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_EQ(none->points.size(), 2U);
    EXPECT_TRUE(none->points.color.empty());
    expectObjError("v 1 2 3 0 0 1\nv 1 2 3 inf 0 0\n", ErrorCode::Malformed, "colours are 0 to 1");
}

TEST(ObjSource, LinesAreJoinedByABackslash) {
    const auto joined =
        readObj("# in C:\\scans\\\nv 1 \\\n2 \\\r\n 3\nf 1 \\\n 1 \\\n 1\nv 4 5 6 # the last\nv 7 8 9\\");
    ASSERT_TRUE(joined) << joined.error().message;
    EXPECT_THAT(joined->points.position,
                ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6), glm::dvec3(7, 8, 9)));
    EXPECT_THAT(joined->notes, ElementsAre(HasSubstr("1 face")));
}

TEST(ObjSource, NumbersThatAreNoPlaceAreDroppedAndCounted) {
    const auto scan = readObj("v 1 2 3\nv nan 0 0\nv 0 inf 0\n");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points.size(), 1U);
    EXPECT_EQ(scan->dropped, 2U);
    expectObjError("v nan 0 0\n", ErrorCode::Empty, "none of its 1 vertices");
}

TEST(ObjSource, SaysWhatIsWrongAndWhere) {
    expectObjError("v 1 2 3\nf 1 1 1\nv 1 2\n", ErrorCode::Malformed,
                   "line 3: a vertex has less than 3 numbers");
    expectObjError("v 1 2 3 4 5\n", ErrorCode::Malformed, "has 5 numbers");
    expectObjError("v 1 2 3 4 5 6 7 8\n", ErrorCode::Malformed, "more than 7 numbers");
    expectObjError("v 1 2 x\n", ErrorCode::Malformed, "no number");
    expectObjError("v 1 2 3e\n", ErrorCode::Malformed, "no number");
    expectObjError("v 1 2 3 -1 0 0\n", ErrorCode::Malformed, "colours are 0 to 1");
    expectObjError("o nothing\nf 1 2 3\nf 1 2 3\n", ErrorCode::Empty, "2 faces, but no vertex");
    expectObjError("o nothing\n", ErrorCode::Empty, "no vertex");
}

TEST(ObjSource, IsKnownByItsWords) {
    EXPECT_EQ(formatOf("# x\nv 1 2 3\nv 4 5 6\n", ".obj"), ScanFormat::Obj);
    EXPECT_EQ(formatOf("mtllib a.mtl\ng\nv 1 2 3\n", ".txt"), ScanFormat::Obj);
    EXPECT_EQ(formatOf("# only a long comment so far\n", ".obj"), ScanFormat::Obj);
    EXPECT_EQ(formatOf("1 2 3\n4 5 6\n", ".obj"), ScanFormat::Text) << "content goes before the name";
    EXPECT_EQ(formatOf("v 1 2 3\nhello\nthis is\nno\nscan\n", ".obj"), ScanFormat::Unknown);
    EXPECT_EQ(formatOf("g of text\n", ".txt"), ScanFormat::Unknown);
}

}  // namespace scancast::test
