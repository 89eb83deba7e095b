// Texts of points, written here: every separator, header and order of columns that programs write, and what
// is wrong with the others. Oracle: the numbers stand in the text.
#include "renderer/cloud/import/text/text_source.hpp"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/unit/import/text_scan.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

struct Read {
    ScanHeader header;
    PointBatch points;
    std::uint64_t dropped = 0;
};

Expected<Read> readText(const std::string& text, const TextOptions& options = {}, bool seekable = true) {
    auto source = TextSource::create(bytesOf(text, seekable), "a.xyz", options);
    if (!source) return passOn(source);
    auto points = readAll(**source);
    if (!points) return passOn(points);
    return Read{(*source)->header(), std::move(*points), (*source)->droppedPoints()};
}

void expectTextError(const std::string& text, ErrorCode code, const char* reason) {
    const auto scan = readText(text);
    ASSERT_FALSE(scan) << text;
    EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
    EXPECT_THAT(scan.error().message, HasSubstr("a.xyz"));
    EXPECT_THAT(scan.error().message, HasSubstr(reason));
}

using Rgb = std::array<std::uint8_t, 3>;

}  // namespace

// The same three points, however they are separated: one answer.
TEST(TextSource, SeparatorsAndEndsOfLines) {
    for (const std::string text :
         {"1 2 3\n-4.5 5e1 6\n7 8 9\n", "1\t2\t3\n-4.5\t5e1\t6\n7\t8\t9", "1,2,3\r\n-4.5,5e1,6\r\n7,8,9\r\n",
          "1, 2, 3\n-4.5 ,5e1 ,+6\n7,8,9", "1;2;3\n-4,5;5e1;6\n7;8;9\n",
          "  1   2 3  \n -4.5\t 5e1 6\n7 8 9 \n", "1 2 3\r-4.5 5e1 6\r7 8 9\r",
          "\xef\xbb\xbf"
          "1 2 3\n\n-4.5 5e1 6\n\n7 8 9\n\n",
          "# three\n1 2 3\n// points\n-4.5 5e1 6\n7 8 9\n",
          "\"1\",\"2\",\"3\"\n\"-4.5\",\"5e1\",\"6\"\n7,8,9\n", "1,2,3,\n-4.5,5e1,6,\n7,8,9,\n",
          "1 2 3\n-4,5 5e1 6\n7 8 9\n"}) {
        const auto scan = readText(text);
        ASSERT_TRUE(scan) << text << scan.error().message;
        EXPECT_THAT(scan->points.position,
                    ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(-4.5, 50, 6), glm::dvec3(7, 8, 9)))
            << text;
        EXPECT_EQ(scan->header.attributes, Attributes{});
        EXPECT_EQ(scan->header.points, std::nullopt);
    }
}

TEST(TextSource, NamesOfColumns) {
    for (const char* head :
         {"//X,Y,Z,R,G,B,Intensity,Classification,Nx,Ny,Nz\n", "# x y z red green blue i class nx ny nz\n",
          "X;Y;Z;Red;Green;Blue;INTENSITY;Classification;NX;NY;NZ\n",
          "easting [m]\tnorthing [m]\televation "
          "[m]\tr\tg\tb\tintensity\tclass\tnormal_x\tnormal_y\tnormal_z\n"}) {
        std::string row = "1 2 3 10 20 30 400 6 0 0 2\n";
        const char mark = std::strchr(head, ';') ? ';' : std::strchr(head, ',') ? ',' : ' ';
        for (char& c : row)
            if (c == ' ') c = mark;
        const auto scan = readText(head + row);
        ASSERT_TRUE(scan) << head << scan.error().message;
        EXPECT_EQ(scan->points.position[0], glm::dvec3(1, 2, 3));
        EXPECT_EQ(scan->points.color[0], (Rgb{10, 20, 30}));
        EXPECT_EQ(scan->points.intensity[0], 400);
        EXPECT_EQ(scan->points.classification[0], 6);
        EXPECT_EQ(scan->points.normal[0], glm::vec3(0, 0, 1));
        EXPECT_EQ(scan->header.format, "text: x y z red green blue intensity classification nx ny nz");
    }
}

TEST(TextSource, NamesInAnyOrder) {
    const auto scan = readText("label,z,y,x,b,g,r\nwall,3,2,1,30,20,10\nroof,6,5,4,60,50,40\n");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_THAT(scan->points.position, ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6)));
    EXPECT_THAT(scan->points.color, ElementsAre(Rgb{10, 20, 30}, Rgb{40, 50, 60}));
    EXPECT_EQ(scan->header.format, "text: - z y x blue green red");
}

// A comment that happens to have those words is no header when it does not fit.
TEST(TextSource, CommentsNeedNotBeHeaders) {
    const auto scan = readText("# x y z in metres\n1 2 3\n4 5 6\n");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points.size(), 2U);
}

TEST(TextSource, GuessesByNumberAndRange) {
    for (const auto& [row, format] :
         {std::pair("1 2 3", "text: x y z"),
          {"1 2 3 40", "text: x y z intensity"},
          {"1 2 3 40 50", "text: x y z - -"},
          {"1 2 3 40 50 60", "text: x y z red green blue"},
          {"1 2 3 0.25 0.5 0.75", "text: x y z red green blue"},
          {"1 2 3 0.6 0 -0.8", "text: x y z nx ny nz"},
          {"1 2 3 0.0 0.0 1.0", "text: x y z nx ny nz"},
          {"1 2 3 -40 50 60", "text: x y z - - -"},
          {"1 2 3 -700 50 60 70", "text: x y z intensity red green blue"},
          {"1 2 3 50 60 70 -700", "text: x y z red green blue intensity"},
          {"1 2 3 0.6 0 0.8 9000.5", "text: x y z nx ny nz intensity"},
          {"1 2 3 9000.5 0.6 0 0.8", "text: x y z intensity nx ny nz"},
          {"1 2 3 4 5 6 0.6 0 0.8", "text: x y z red green blue nx ny nz"},
          {"1 2 3 0.6 0 0.8 4 5 6", "text: x y z nx ny nz red green blue"},
          {"1 2 3 77 4 5 6 0.6 0 0.8", "text: x y z intensity red green blue nx ny nz"}}) {
        const auto scan = readText(std::string(row) + "\n" + row + "\n");
        ASSERT_TRUE(scan) << row << scan.error().message;
        EXPECT_EQ(scan->header.format, format) << row;
    }
}

TEST(TextSource, RangesOfColors) {
    const auto bytes = readText("1 2 3 0 128 255\n");
    const auto words = readText("1 2 3 0 32768 65535\n1 2 3 256 511 512\n");
    const auto units = readText("1 2 3 0.0 0.5 1.0\n1 2 3 1 1 0.002\n");
    ASSERT_TRUE(bytes && words && units);
    EXPECT_EQ(bytes->points.color[0], (Rgb{0, 128, 255}));
    EXPECT_THAT(words->points.color, ElementsAre(Rgb{0, 128, 255}, Rgb{1, 1, 2}));
    EXPECT_THAT(units->points.color, ElementsAre(Rgb{0, 128, 255}, Rgb{255, 255, 1}));
}

// Programs that write all columns with the same number of decimals write colours so, too.
TEST(TextSource, WholeColorsOf16BitsMayHaveDecimals) {
    const auto named =
        readText("x,y,z,red,green,blue\n1,2,3,9728.000,40960.000,55808.0\n1,2,3,0.000,255.000,1e3\n");
    ASSERT_TRUE(named) << named.error().message;
    EXPECT_THAT(named->points.color, ElementsAre(Rgb{38, 160, 218}, Rgb{0, 0, 3}));
    const auto parts = readText("x,y,z,red,green,blue\n1,2,3,9728.5,40960.000,55808.000\n");
    ASSERT_FALSE(parts);
    EXPECT_THAT(parts.error().message, HasSubstr("hold numbers from 9728.5"));
    const auto nameless = readText("1 2 3 9728.000 40960.000 55808.000\n");
    ASSERT_TRUE(nameless) << nameless.error().message;
    EXPECT_EQ(nameless->header.format, "text: x y z - - -");
}

TEST(TextSource, RangesOfIntensity) {
    const auto plain = readText("1 2 3 0\n1 2 3 255\n1 2 3 65535\n1 2 3 99.6\n1 2 3 1e9\n");
    const auto unit = readText("1 2 3 0.0\n1 2 3 0.5\n1 2 3 1\n");
    const auto low = readText("1 2 3 -2048\n1 2 3 -1\n1 2 3 2047\n");
    const auto pts = readText("3\n1 2 3 0\n1 2 3 1\n1 2 3 2\n");
    ASSERT_TRUE(plain && unit && low && pts);
    EXPECT_THAT(plain->points.intensity, ElementsAre(0, 255, 65535, 100, 65535));
    EXPECT_THAT(unit->points.intensity, ElementsAre(0, 32768, 65535));
    // (i + 2048) · 65535 / 4095 by hand: 0; 2047 · 16.00366… = 32759.5; 65535.
    EXPECT_THAT(low->points.intensity, ElementsAre(0, 32759, 65535));
    EXPECT_THAT(pts->points.intensity, ElementsAre(32776, 32792, 32808));
    EXPECT_EQ(pts->header.format, "PTS: x y z intensity");
}

// The beginning is dark, 16 bits show later: a file is looked at all over, a pipe cannot be.
TEST(TextSource, LooksAtTheWholeFile) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += i < 50000 ? "1 2 3 9 9 9\n" : "1 2 3 2560 512 9\n";
    const auto file = readText(text);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->points.color.back(), (Rgb{10, 2, 0}));
    const auto pipe = readText(text, {}, false);
    ASSERT_FALSE(pipe);
    EXPECT_THAT(pipe.error().message,
                HasSubstr("line 50,001: column 4: the colour 2560 is outside of 0 to 255"));
}

TEST(TextSource, PtsOfSeveralScans) {
    const auto scan = readText("2\n1 2 3 9\n4 5 6 9\n\n1\n7 8 9 9\n");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_THAT(scan->points.position,
                ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6), glm::dvec3(7, 8, 9)));
    // CloudCompare writes names first, then the count.
    const auto named = readText("//X Y Z\n2\n1 2 3\n4 5 6\n");
    ASSERT_TRUE(named) << named.error().message;
    EXPECT_EQ(named->points.size(), 2U);
}

TEST(TextSource, WrongCounts) {
    expectTextError("3\n1 2 3\n4 5 6\n", ErrorCode::Truncated,
                    "line 3: the count of points promises 3, there are 2");
    expectTextError("3\n1 2 3\n4 5 6\n1\n7 8 9\n", ErrorCode::Truncated, "promises 3, there are 2");
    expectTextError("18446744073709551615\n1 2 3\n", ErrorCode::Truncated, "there are 1");
    // Too small a count loses nothing: real files have it.
    const auto more = readText("1\n1 2 3\n4 5 6\n");
    ASSERT_TRUE(more);
    EXPECT_EQ(more->points.size(), 2U);
}

TEST(TextSource, WhatCannotBeUnderstood) {
    expectTextError("1 2 3\n4 five 6\n", ErrorCode::Malformed, "line 2: column 2: \"five\" is not a number");
    expectTextError("1 2 3\n4 5\n", ErrorCode::Malformed,
                    "line 2: there are 2 columns, but 3 on the lines before");
    expectTextError("1 2 3\n4 5 6 7\n", ErrorCode::Malformed, "line 2: there are 4 columns, but 3");
    expectTextError("1,2,3\n4,,6\n", ErrorCode::Malformed, "line 2: column 2 is empty");
    expectTextError("1 2 3\n1.5.2 5 6\n", ErrorCode::Malformed, "\"1.5.2\" is not a number");
    expectTextError("1 2 3\n1e999 5 6\n", ErrorCode::Malformed, "\"1e999\" is not a number");
    expectTextError("1 2\n3 4\n", ErrorCode::Malformed, "line 1: there are 2 columns");
    expectTextError("a b c\n1 2 3\n", ErrorCode::Malformed,
                    "line 1: \"a b c\" is neither a point nor a header");
    expectTextError("x y w\n1 2 3\n", ErrorCode::Malformed, "line 1: no column is called \"z\"");
    expectTextError("x y z x\n1 2 3 4\n", ErrorCode::Malformed, "line 1: two columns are called \"x\"");
    expectTextError("x y z\n1 2 3 4\n", ErrorCode::Malformed,
                    "line 1: 3 columns are named, but the first point has 4");
    expectTextError("x y z r g b\n1 2 3 -4 5 6\n", ErrorCode::Malformed, "colours are 0 to 255");
    expectTextError("x y z class\n1 2 3 256\n", ErrorCode::Malformed, "line 2: the class 256");
    expectTextError("3\n2\n1 2 3\n", ErrorCode::Malformed, "line 2: a second number of points");
    expectTextError("# nothing\n", ErrorCode::Empty, "without points");
    expectTextError("x y z\n", ErrorCode::Empty, "without points");
    expectTextError("0\n", ErrorCode::Empty, "without points");
    expectTextError("nan nan nan\n", ErrorCode::Empty, "none of its 1 points has finite coordinates");
    expectTextError("1 2 3\n" + std::string(100000, ' ') + "\n", ErrorCode::Malformed,
                    "line 2: the line is longer than 65,536 bytes");
    expectTextError(std::string(300000, '1'), ErrorCode::Malformed, "line 1: the line is longer");
    expectTextError(std::string("\xff\xfe"
                                "1\0 \0",
                                6),
                    ErrorCode::Unsupported, "UTF-16");
    std::string wide;
    for (int i = 0; i < 300; ++i) wide += "1 ";
    expectTextError(wide + "\n", ErrorCode::Malformed, "there are 300 columns; at most 256");
}

TEST(TextSource, DropsWhatIsNoPlace) {
    const auto scan = readText("1 2 3\nnan 5 6\n4 inf 6\n7 8 9\n");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points.size(), 2U);
    EXPECT_EQ(scan->dropped, 2U);
}

TEST(TextSource, KeepsSpareColumnsOnRequest) {
    const std::string text = "x,y,z,gps time,label,\"range\"\n1,2,3,0.1,wall,-7\n4,5,6,1e300,roof,8\n";
    EXPECT_TRUE(readText(text)->header.columns.empty());
    const auto scan = readText(text, {.keepAttributes = true});
    ASSERT_TRUE(scan) << scan.error().message;
    ASSERT_EQ(scan->header.columns.size(), 2U);
    EXPECT_EQ(scan->header.columns[0].name, "gps time");
    EXPECT_EQ(scan->header.columns[1].name, "range");
    EXPECT_EQ(scan->header.columns[0].type, ColumnType::Float64);
    std::array<double, 4> values{};
    ASSERT_EQ(scan->points.rows.size(), sizeof values);
    std::memcpy(values.data(), scan->points.rows.data(), sizeof values);
    EXPECT_THAT(values, ElementsAre(0.1, -7, 1e300, 8));
    const auto unnamed = readText("1 2 3 4 5\n", {.keepAttributes = true});
    ASSERT_TRUE(unnamed);
    EXPECT_EQ(unnamed->header.columns.at(1).name, "column_5");
}

// A pipe hands out odd pieces, and one batch is not all: the points must be those of the file.
TEST(TextSource, PipesAndManyBatches) {
    std::string text = "x y z intensity\n";
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i)
        text +=
            std::to_string(i) + " " + std::to_string(i % 7) + ".25 -1e-3 " + std::to_string(i % 1000) + "\n";
    for (const bool seekable : {true, false}) {
        const auto scan = readText(text, {}, seekable);
        ASSERT_TRUE(scan) << scan.error().message;
        ASSERT_EQ(scan->points.size(), std::size_t(count));
        for (int i = 0; i < count; ++i) {
            ASSERT_EQ(scan->points.position[std::size_t(i)], glm::dvec3(i, i % 7 + 0.25, -1e-3));
            ASSERT_EQ(scan->points.intensity[std::size_t(i)], i % 1000);
        }
    }
}

}  // namespace scancast::test
