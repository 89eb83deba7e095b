// The real files, of which an independent program printed numbers of points, fields and boxes (SOURCES.md, beside them).
// Where it has no box, the file's own one is taken, or what is known of its few points.
#include <gmock/gmock.h>

#include <glm/common.hpp>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

struct RealFile {
    const char* file;
    std::uint64_t points, dropped;
    const char* columns;  ///< c colour, i intensity, n normal
    glm::dvec3 size, least;
    double tolerance;
};

void PrintTo(const RealFile& real, std::ostream* out) {
    *out << real.file;
}

const glm::dvec3 bunnySize(0.156, 0.147, 0.121), bunnyLeast(-0.095, 0.040, -0.062);
const RealFile realFiles[] = {
    {"e57/ColouredCubeFloat.e57", 7680, 0, "c", {1, 1, 1}, {-0.5, -0.5, -0.5}, 1e-6},
    {"e57/bunnyDouble.e57", 30571, 0, "", bunnySize, bunnyLeast, 5.1e-4},
    {"e57/bunnyFloat.e57", 30571, 0, "", bunnySize, bunnyLeast, 5.1e-4},
    {"e57/bunnyInt19.e57", 30571, 0, "", bunnySize, bunnyLeast, 5.1e-4},
    {"e57/bunnyInt32.e57", 30571, 0, "", bunnySize, bunnyLeast, 5.1e-4},
    {"e57/float_intensity_without_min_max.e57", 1, 0, "i", {0, 0, 0}, {1, 1, 1}, 0},
    {"e57/las2e57_no_images_tag.e57", 153, 0, "c", {1, 1, 1}, {-0.5, -0.5, -0.5}, 1e-12},
    {"e57/pump-laser-scan.e57", 155201, 0, "ci", {4.625, 4.508, 3.743}, {-2.904, -5.301, -1.900}, 5.1e-4},
    {"e57/scaled_integer_intensity.e57", 2, 0, "i", {3.3, 3.3, 3.3}, {1.1, 2.2, 3.3}, 1e-12},
    {"e57/tinyCartesianFloatRgb.e57", 2090, 0, "c", {3.005, 3.002, 3.007}, {-9.780, 4.514, 295.52}, 6e-3},
    {"e57/tiny_pc_and_images.e57", 2, 0, "", {1, 1, 1}, {0, 0, 0}, 0},
    {"e57/tiny_pc_with_extension.e57", 1, 0, "n", {0, 0, 0}, {1, 2, 3}, 0},
    // Every other one is marked as no point.
    {"e57/tiny_spherical.e57", 180, 180, "", {1, 1, 1}, {0, -0.5, 0}, 1e-4},
};

std::string nameOf(const ::testing::TestParamInfo<RealFile>& test) {
    std::string name = test.param.file + 4;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

class RealE57 : public ::testing::TestWithParam<RealFile> {};

}  // namespace

TEST_P(RealE57, GivesWhatIsInIt) {
    const auto& real = GetParam();
    REQUIRE_TEST_DATA(real.file);
    const auto result = imported(contentOf(testData(real.file)));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->points.size(), real.points);
    EXPECT_EQ(result->dropped, real.dropped);
    const std::string_view columns(real.columns);
    const auto& has = result->header.attributes;
    EXPECT_EQ(has.color, columns.find('c') != std::string_view::npos);
    EXPECT_EQ(has.intensity, columns.find('i') != std::string_view::npos);
    EXPECT_EQ(has.normal, columns.find('n') != std::string_view::npos);
    glm::dvec3 low(1e300), high(-1e300);
    for (const auto& p : result->points.position) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(low[i], real.least[i], real.tolerance) << i;
        EXPECT_NEAR(high[i] - low[i], real.size[i], real.tolerance) << i;
        if (!result->header.bounds) continue;
        EXPECT_GE(low[i], (*result->header.bounds)[0][i] - 1e-6) << i;
        EXPECT_LE(high[i], (*result->header.bounds)[1][i] + 1e-6) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(All, RealE57, ::testing::ValuesIn(realFiles), nameOf);

// One bunny in four encodings.
TEST(RealE57Files, AreTheSameInEveryEncoding) {
    REQUIRE_TEST_DATA("e57/bunnyDouble.e57");
    const auto exact = imported(contentOf(testData("e57/bunnyDouble.e57"))).value();
    for (const char* file : {"e57/bunnyFloat.e57", "e57/bunnyInt19.e57", "e57/bunnyInt32.e57"}) {
        const auto other = imported(contentOf(testData(file))).value();
        ASSERT_EQ(other.points.size(), exact.points.size());
        for (std::size_t i = 0; i < exact.points.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_NEAR(other.points.position[i][axis], exact.points.position[i][axis], 6e-7)
                    << file << " " << i;
    }
}

TEST(RealE57Files, OfAScannerKnowWhereItStood) {
    REQUIRE_TEST_DATA("e57/pump-laser-scan.e57");
    const auto pump = imported(contentOf(testData("e57/pump-laser-scan.e57"))).value();
    ASSERT_TRUE(pump.header.scannerOrigin);
    EXPECT_EQ(*pump.header.scannerOrigin, glm::dvec3(0));
    EXPECT_NEAR(pump.header.gridStep.x, 1e-6, 1e-18);
    REQUIRE_TEST_DATA("e57/tiny_pc_and_images.e57");
    const auto tiny = imported(contentOf(testData("e57/tiny_pc_and_images.e57"))).value();
    EXPECT_THAT(tiny.notes, ::testing::ElementsAre("2 photos left out: neither JPEG nor PNG")) << "but zeros";
    ASSERT_EQ(tiny.photos.size(), 2U);
    EXPECT_EQ(tiny.photos[0].bytes, 7722U);
    EXPECT_EQ(tiny.photos[1].projection, Photo::Projection::Spherical);
}

TEST(RealE57Files, ThatAreBadAreRefused) {
    const std::tuple<const char*, ErrorCode, const char*> bad[] = {
        {"bad/corrupt_crc.e57", ErrorCode::Malformed, "the page at byte 33,792 is damaged"},
        {"bad/InvalidCVHeader.e57", ErrorCode::Malformed, "byte 48: its scan: its points should begin here"},
        {"bad/empty.e57", ErrorCode::Empty, "an E57 file without scans"},
        {"e57/empty_pc.e57", ErrorCode::Empty, "an E57 file without points"},
    };
    for (const auto& [file, code, reason] : bad) {
        REQUIRE_TEST_DATA(file);
        expectRefused(contentOf(testData(file)), code, reason);
    }
}

}  // namespace scancast::test
