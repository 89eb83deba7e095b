// PLY and PCD files written here, through the real importer process: what was written is what is read.
// Numbers, byte orders and layouts that no scan at hand has; and damage.
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>

#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

using Color = std::array<std::uint8_t, 3>;

/// Bytes in the order of a file.
class Binary {
  public:
    explicit Binary(bool bigEndian = false) : bigEndian_(bigEndian) {}
    template <class T>
    Binary& operator<<(T value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        if (bigEndian_) std::reverse(bytes, bytes + sizeof value);
        text.append(bytes, sizeof value);
        return *this;
    }
    std::string text;

  private:
    bool bigEndian_;
};

class PclImporter : public ::testing::Test {
  protected:
    Expected<ScanSummary> read(const std::string& content, std::uint64_t* dropped = nullptr) {
        auto source = openScan(folder_.write("scan", content), {.importerDirectory = SCANCAST_BIN_DIR});
        if (!source) return passOn(source);
        auto scan = summarize(**source);
        if (dropped) *dropped = (*source)->droppedPoints();
        return scan;
    }

    ScanSummary sound(const std::string& content) {
        auto scan = read(content);
        EXPECT_TRUE(scan) << scan.error().message;
        return scan.value_or(ScanSummary{});
    }

    void expectError(const std::string& content, ErrorCode code, const char* reason) {
        const auto scan = read(content);
        ASSERT_FALSE(scan) << reason;
        EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
        EXPECT_THAT(scan.error().message, HasSubstr((folder_.path() / "scan").string()));
        EXPECT_THAT(scan.error().message, HasSubstr(reason));
    }

    TemporaryFolder folder_;
};

std::string plyHeader(const std::string& format, int vertices, const std::string& properties) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) + "\n" + properties +
           "end_header\n";
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";

std::string pcdHeader(const std::string& fields, const std::string& sizes, const std::string& types,
                      int points, const std::string& data) {
    return "VERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nWIDTH " +
           std::to_string(points) + "\nHEIGHT 1\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n";
}

const std::string pcdXyz = pcdHeader("x y z", "4 4 4", "F F F", 2, "ascii");

}  // namespace

// Every number type, in both byte orders, with lists before and between: the layout is the header's, nothing
// else.
TEST_F(PclImporter, PlyOfEveryType) {
    for (const bool big : {false, true}) {
        const std::string properties =
            "property char a\nproperty double x\nproperty list uchar short junk\nproperty ushort b\nproperty "
            "double y\n"
            "property int c\nproperty double z\nproperty uint d\nproperty uchar red\nproperty uchar "
            "green\nproperty "
            "uchar blue\nproperty short classification\nproperty ushort intensity\nproperty float "
            "nx\nproperty float "
            "ny\nproperty float nz\n";
        Binary body(big);
        for (int i = 0; i < 3; ++i) {
            body << std::int8_t(-1) << 4321098.765 + i << std::uint8_t(i);
            for (int k = 0; k < i; ++k) body << std::int16_t(77);
            body << std::uint16_t(9) << -0.125 * i << std::int32_t(-5) << 1e-9 * i << std::uint32_t(8);
            body << std::uint8_t(i) << std::uint8_t(200) << std::uint8_t(255);
            body << std::int16_t(i == 2 ? 300 : i + 5) << std::uint16_t(1000 * i);
            body << 0.0F << float(2 * i) << 0.0F;
        }
        const auto scan =
            sound(plyHeader(big ? "binary_big_endian" : "binary_little_endian", 3, properties) + body.text);
        ASSERT_EQ(scan.points, 3U);
        for (int i = 0; i < 3; ++i)
            EXPECT_EQ(scan.first.position[std::size_t(i)], glm::dvec3(4321098.765 + i, -0.125 * i, 1e-9 * i));
        EXPECT_THAT(scan.first.color,
                    ElementsAre(Color{0, 200, 255}, Color{1, 200, 255}, Color{2, 200, 255}));
        EXPECT_THAT(scan.first.classification, ElementsAre(5, 6, 0));
        EXPECT_THAT(scan.first.intensity, ElementsAre(0, 1000, 2000));
        EXPECT_THAT(scan.first.normal, ElementsAre(glm::vec3(0), glm::vec3(0, 1, 0), glm::vec3(0, 1, 0)));
    }
}

TEST_F(PclImporter, PlyElementsAroundTheVertices) {
    const std::string text =
        "ply\r\nformat ascii 1.0\r\ncomment a b c\r\nelement camera 2\r\nproperty float f\r\nproperty list "
        "uchar int "
        "l\r\nelement vertex 2\r\nproperty float X\r\nproperty float Y\r\nproperty float Z\r\nelement face "
        "1\r\n"
        "property list uchar int vertex_indices\r\nend_header\r\n0.5 2 7 8\r\n0.5 0\r\n1 2 3\r\n4 5 6\r\n3 0 "
        "1 0\r\n";
    const auto scan = sound(text);
    EXPECT_THAT(scan.first.position, ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6)));
    // Damage behind the vertices harms no point.
    EXPECT_EQ(sound(text.substr(0, text.size() - 6)).points, 2U);
}

// An oracle: with an empty list before the vertices, they are PCL's to read; without, they are rows of numbers.
TEST_F(PclImporter, RowsOfNumbersAreWhatPclReads) {
    const std::string properties =
        "property double x\nproperty float y\nproperty int z\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nproperty ushort intensity\nproperty short spare\nproperty char class\n"
        "property float nx\nproperty double ny\nproperty float nz\n";
    const std::string packed =
        "property ushort spare\nproperty float z\nproperty double y\nproperty float x\n"
        "property float rgb\nproperty uint intensity\n";
    std::uint32_t state = 1;
    for (const bool bigEndian : {false, true})
        for (const std::string& vertex : {properties, packed}) {
            const int vertices = 500;
            std::string body;
            for (int i = 0; i < vertices * 60; ++i) {
                state = state * 1664525 + 1013904223;
                body += static_cast<char>(state >> 24);
            }
            const std::string start =
                std::string("ply\nformat binary_") + (bigEndian ? "big" : "little") + "_endian 1.0\n";
            const std::string element =
                "element vertex " + std::to_string(vertices) + "\n" + vertex + "end_header\n";
            std::uint64_t dropped = 0, droppedByPcl = 0;
            const auto ours = read(start + element + body, &dropped);
            const auto pcls = read(start + "element other 1\nproperty list uchar int items\n" + element +
                                       std::string(1, '\0') + body,
                                   &droppedByPcl);
            ASSERT_TRUE(ours) << ours.error().message;
            ASSERT_TRUE(pcls) << pcls.error().message;
            EXPECT_GT(ours->first.position.size(), 100U);
            EXPECT_EQ(ours->first.position, pcls->first.position);
            EXPECT_EQ(ours->first.color, pcls->first.color);
            EXPECT_EQ(ours->first.intensity, pcls->first.intensity);
            EXPECT_EQ(ours->first.classification, pcls->first.classification);
            EXPECT_EQ(ours->first.normal, pcls->first.normal);
            EXPECT_EQ(dropped, droppedByPcl);
        }
}

TEST_F(PclImporter, NanPointsAreDroppedAndCounted) {
    std::uint64_t dropped = 0;
    const auto ply = read(plyHeader("ascii", 3, xyz) + "1 2 3\nnan 2 3\n4 inf 6\n", &dropped);
    ASSERT_TRUE(ply) << ply.error().message;
    EXPECT_EQ(ply->points, 1U);
    EXPECT_EQ(dropped, 2U);
    const auto pcd = read(pcdXyz + "nan nan nan\n1 2 3\n", &dropped);
    ASSERT_TRUE(pcd) << pcd.error().message;
    EXPECT_EQ(pcd->points, 1U);
    EXPECT_EQ(dropped, 1U);
    expectError(pcdXyz + "nan nan nan\nnan 1 2\n", ErrorCode::Empty,
                "none of its 2 points has finite coordinates");
}

// The scaling rules of point_converter.hpp, each with the values that decide it.
TEST_F(PclImporter, Intensities) {
    const auto read = [&](const std::string& type, const std::string& a, const std::string& b) {
        return sound(plyHeader("ascii", 2, xyz + "property " + type + " intensity\n") + "0 0 0 " + a +
                     "\n0 0 1 " + b + "\n")
            .first.intensity;
    };
    EXPECT_THAT(read("ushort", "7", "254"), ElementsAre(7, 254));
    EXPECT_THAT(read("uchar", "1", "255"), ElementsAre(257, 65535));
    EXPECT_THAT(read("int", "1", "255"), ElementsAre(1, 255));
    EXPECT_THAT(read("float", "0.5", "1"), ElementsAre(32768, 65535));
    EXPECT_THAT(read("float", "0.5", "255"), ElementsAre(129, 65535));
    EXPECT_THAT(read("double", "2.4", "4095"), ElementsAre(2, 4095));
    EXPECT_THAT(read("float", "-20", "-10"), ElementsAre(0, 65535));
    EXPECT_THAT(read("int", "100000", "300000"), ElementsAre(0, 65535));
    EXPECT_THAT(read("double", "-1e308", "1.5e308"), ElementsAre(0, 65535));
    EXPECT_THAT(read("float", "-5", "-5"), ElementsAre(0, 0));
    EXPECT_THAT(read("float", "nan", "1"), ElementsAre(0, 65535));
}

TEST_F(PclImporter, Colours) {
    const auto read = [&](const std::string& type, const std::string& a, const std::string& b) {
        return sound(plyHeader("ascii", 2,
                               xyz + "property " + type + " red\nproperty " + type + " green\nproperty " +
                                   type + " blue\n") +
                     "0 0 0 " + a + "\n0 0 1 " + b + "\n")
            .first.color;
    };
    EXPECT_THAT(read("uchar", "1 2 3", "255 0 9"), ElementsAre(Color{1, 2, 3}, Color{255, 0, 9}));
    EXPECT_THAT(read("ushort", "1 2 3", "255 0 9"), ElementsAre(Color{1, 2, 3}, Color{255, 0, 9}));
    EXPECT_THAT(read("ushort", "255 256 511", "65535 0 65280"),
                ElementsAre(Color{0, 1, 1}, Color{255, 0, 255}));
    EXPECT_THAT(read("float", "0 0.5 1", "1 0 0.2"), ElementsAre(Color{0, 128, 255}, Color{255, 0, 51}));
    EXPECT_THAT(read("float", "0 128 255", "1 -3 nan"), ElementsAre(Color{0, 128, 255}, Color{1, 0, 0}));
}

// A packed colour's bytes are 0xAARRGGBB, whether they are called an integer or a float.
TEST_F(PclImporter, PackedColours) {
    for (const auto& [name, type] : {std::pair("rgb", "F"), {"rgb", "U"}, {"rgba", "U"}}) {
        Binary body;
        body << 1.0F << 2.0F << 3.0F << std::uint32_t(0xff102030) << 4.0F << 5.0F << 6.0F
             << std::uint32_t(0x00fffe01);
        const auto scan = sound(
            pcdHeader(std::string("x y z ") + name, "4 4 4 4", std::string("F F F ") + type, 2, "binary") +
            body.text);
        EXPECT_THAT(scan.first.color, ElementsAre(Color{16, 32, 48}, Color{255, 254, 1}));
        EXPECT_EQ(scan.first.position[1], glm::dvec3(4, 5, 6));
    }
}

TEST_F(PclImporter, PcdOfEveryType) {
    const std::string header =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS a x pad y Label z hist\nSIZE 1 8 2 8 4 8 4\nTYPE I F U F U F F\n"
        "COUNT 1 1 3 1 1 1 2\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ";
    Binary body;
    std::string text;
    for (int i = 0; i < 4; ++i) {
        body << std::int8_t(-2) << 500000.25 + i << std::uint16_t(1) << std::uint16_t(2) << std::uint16_t(3)
             << 5000000.125 << std::uint32_t(i) << -1.5 * i << 0.5F << 0.25F;
        text += "-2 " + std::to_string(500000.25 + i) + " 1 2 3 5000000.125\t" + std::to_string(i) + " " +
                std::to_string(-1.5 * i) + " 0.5 0.25\n";
    }
    for (const auto& content : {header + "binary\n" + body.text, header + "ascii\n" + text}) {
        const auto scan = sound(content);
        ASSERT_EQ(scan.points, 4U);
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(scan.first.position[std::size_t(i)], glm::dvec3(500000.25 + i, 5000000.125, -1.5 * i));
        EXPECT_THAT(scan.first.classification, ElementsAre(0, 1, 2, 3));
    }
}

// Programs that do not know where the sensor stood write the origin; what is no place counts as that. Only a frame
// with rows and columns counts from its camera.
TEST_F(PclImporter, PcdTellsWhereTheSensorStood) {
    const auto stoodAt = [&](const std::string& viewpoint, int width = 1, int height = 1) {
        std::string points;
        for (int i = 0; i < width * height; ++i) points += "1 2 3\n";
        const auto source = openScan(
            folder_.write("scan", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " +
                                      std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
                                      "\nVIEWPOINT " + viewpoint + "\nPOINTS " +
                                      std::to_string(width * height) + "\nDATA ascii\n" + points),
            {.importerDirectory = SCANCAST_BIN_DIR});
        EXPECT_TRUE(source) << source.error().message;
        return source ? (*source)->header().scannerOrigin : std::nullopt;
    };
    EXPECT_EQ(stoodAt("500000.25 -2 1e1 1 0 0 0"), glm::dvec3(500000.25, -2, 10));
    EXPECT_EQ(stoodAt("0 0 0 0 1 0 0"), std::nullopt);
    EXPECT_EQ(stoodAt("1 2 nan 1 0 0 0"), std::nullopt);
    EXPECT_EQ(stoodAt("1 2 3"), std::nullopt);
    EXPECT_EQ(stoodAt("0 0 0 1 0 0 0", 4, 11), glm::dvec3(0));
    EXPECT_EQ(stoodAt("1 2 3 1 0 0 0", 4, 11), glm::dvec3(1, 2, 3));
    EXPECT_EQ(stoodAt("0 0 0 1 0 0 0", 1, 20), std::nullopt);
    EXPECT_EQ(stoodAt("0 0 0 1 0 0 0", 20, 1), std::nullopt);
}

// Slices of the importer, chunks of the stream: the order holds over every seam.
TEST_F(PclImporter, ManyPoints) {
    constexpr int n = 800000;
    Binary body;
    for (int i = 0; i < n; ++i) body << float(i) << float(-i) << 1.0F;
    const auto check = [&](const std::string& content) {
        auto source = openScan(folder_.write("scan", content), {.importerDirectory = SCANCAST_BIN_DIR});
        ASSERT_TRUE(source) << source.error().message;
        PointBatch batch;
        int done = 0;
        for (;;) {
            const auto more = (*source)->read(batch);
            ASSERT_TRUE(more) << more.error().message;
            if (!*more) break;
            for (const auto& p : batch.position) {
                ASSERT_EQ(p, glm::dvec3(done, -done, 1));
                ++done;
            }
        }
        EXPECT_EQ(done, n);
    };
    check(plyHeader("binary_little_endian", n, xyz) + body.text);
    check(pcdHeader("x y z", "4 4 4", "F F F", n, "binary") + body.text);
}

TEST_F(PclImporter, DamagedPly) {
    const auto ply = [](const std::string& rest) { return "ply\n" + rest; };
    const std::string ascii = "format ascii 1.0\n";
    expectError(ply(ascii + "element vertex 5\n" + xyz + "end_header\n1 2 3\n"), ErrorCode::Truncated,
                "promises 5 items");
    expectError(ply(ascii + "element vertex 2\n" + xyz + "end_header\n100 200 300\n40 5\n"),
                ErrorCode::Truncated, "breaks off within vertex 2 of 2");
    expectError(plyHeader("binary_little_endian", 1000000000, xyz) + "abc", ErrorCode::Truncated,
                "there is room for 0");
    expectError(plyHeader("binary_little_endian", 0, xyz), ErrorCode::Empty, "0 vertices");
    expectError(ply("element vertex 5\n" + xyz + "end_header\n"), ErrorCode::Malformed, "no format line");
    expectError(
        "ply\rformat binary_little_endian 1.0\relement vertex 1\r" + xyz + "end_header\r....\n.......",
        ErrorCode::Unsupported, "end in carriage returns only");
    expectError(ply("format ascii 2.0\n"), ErrorCode::Unsupported, "PLY version 2.0");
    expectError(ply("format morse 1.0\n"), ErrorCode::Malformed, "the format \"morse\" is unknown");
    expectError(ply(ascii + "element vertex -5\n"), ErrorCode::Malformed, "the count \"-5\" is not a number");
    expectError(ply(ascii + "element vertex 99999999999999999999\n"), ErrorCode::Malformed,
                "is not a number");
    expectError(ply(ascii + "element vertex 9999999999999999999\n"), ErrorCode::Malformed,
                "more than any file holds");
    expectError(ply(ascii + "element vertex 5\nelement vertex 5\n"), ErrorCode::Malformed, "is there twice");
    expectError(ply(ascii + "property float x\n"), ErrorCode::Malformed, "before the first element");
    expectError(ply(ascii + "element vertex 5\nproperty quad x\n"), ErrorCode::Malformed,
                "the type \"quad\"");
    expectError(ply(ascii + "element vertex 5\nproperty list float int x\n"), ErrorCode::Malformed,
                "a list's length");
    expectError(ply(ascii + "element vertex 5\n" + xyz + "property float x\n"), ErrorCode::Malformed,
                "is there twice");
    expectError(ply(ascii + "element vertex 5\n" + xyz + "property float X\nend_header\n"),
                ErrorCode::Malformed, "same meaning");
    expectError(ply(ascii + "elephant vertex 5\n"), ErrorCode::Malformed, "\"elephant\" is not a word");
    expectError(ply(ascii + "element vertex 5\n" + xyz), ErrorCode::Truncated, "within its PLY header");
    expectError(
        ply(ascii + "element vertex 1\nproperty list uchar float x\n" + xyz.substr(17) + "end_header\n"),
        ErrorCode::Malformed, "no property \"x\"");
}

TEST_F(PclImporter, DamagedPcd) {
    expectError(pcdXyz + "1 2 3\n", ErrorCode::Truncated, "promises 2 points");
    expectError(pcdXyz + "1 2 3\n12345 6\n", ErrorCode::Malformed, "point 2 has 2 values instead of 3");
    expectError(pcdXyz + "1 2 3\n4 five 6\n", ErrorCode::Malformed, "point 2 has a value that is no number");
    expectError(pcdHeader("x y z", "4 4 4", "F F F", 1000000000, "binary") + "abc", ErrorCode::Truncated,
                "promises 1,000,000,000 points");
    expectError(pcdHeader("x y", "4 4", "F F", 1, "ascii") + "1 2\n", ErrorCode::Malformed, "no field \"z\"");
    expectError(pcdHeader("x y z", "4 4", "F F F", 1, "ascii") + "1 2 3\n", ErrorCode::Malformed,
                "SIZE has 2 values");
    expectError(pcdHeader("x y z", "4 4 3", "F F F", 1, "ascii") + "1 2 3\n", ErrorCode::Malformed,
                "no known type");
    expectError(pcdHeader("x y z", "4 4 4", "F F F", 0, "ascii"), ErrorCode::Empty, "0 points");
    expectError(pcdHeader("x y z", "4 4 4", "F F F", 1, "morse"), ErrorCode::Malformed, "DATA is \"morse\"");
    expectError("VERSION 0.7\nFIELDS x y z\n", ErrorCode::Truncated, "within its PCD header");
    expectError("VERSION 0.7\nFIELDS x y z\nDATA ascii\n1 2 3\n", ErrorCode::Malformed, "no line \"SIZE");
    expectError(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n",
        ErrorCode::Malformed, "POINTS is 5, WIDTH x HEIGHT is 4");
    expectError("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 0 1\nWIDTH 1\nDATA ascii\n",
                ErrorCode::Malformed, "the count of y");
    expectError(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 99999999999\nHEIGHT 99999999999\nDATA "
        "binary\n",
        ErrorCode::Malformed, "more than any file holds");
    expectError("VERSION 0.7\nWIDTH 1\nWIDTH 1\n", ErrorCode::Malformed, "WIDTH is there twice");
    expectError("VERSION 0.7\nHELLO 1\n", ErrorCode::Malformed, "\"HELLO\" is not a word");
    const auto compressed = pcdHeader("x y z", "4 4 4", "F F F", 2, "binary_compressed");
    const auto lengths = [](std::uint32_t packed, std::uint32_t unpacked) {
        return (Binary() << packed << unpacked).text;
    };
    expectError(compressed, ErrorCode::Truncated, "before its compressed points");
    expectError(compressed + lengths(100, 24), ErrorCode::Truncated, "100 bytes of compressed points");
    expectError(compressed + lengths(4, 2000000000) + "abcd", ErrorCode::Malformed,
                "unpack to 2,000,000,000 bytes");
    expectError(compressed + lengths(4, 24) + "\xff\xff\xff\xff", ErrorCode::Malformed, "they are damaged");
}

}  // namespace scancast::test
