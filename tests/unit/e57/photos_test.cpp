// Photos of an E57 file: their bytes to the last, what they say they show, and that none costs a point.
#include <gmock/gmock.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <sstream>

#include "tests/unit/e57/imported.hpp"

namespace scancast::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Larger than pages and pieces, unlike itself everywhere.
std::string jpegBytes(std::size_t size = 300'001) {
    std::string bytes = "\xff\xd8\xff";
    while (bytes.size() < size) bytes += char((bytes.size() * bytes.size()) >> 7);
    return bytes;
}
const std::string pngBytes = "\x89PNG\r\n\x1a\n and what not";

std::string bytesOf(const Photo& photo) {
    if (!photo.data) return "none";
    const auto bytes = photo.data->read();
    EXPECT_TRUE(bytes) << bytes.error().message;
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "";
}

std::string number(const char* name, double value) {
    std::ostringstream text;
    text.precision(17);
    text << "<" << name << " type=\"Float\">" << value << "</" << name << ">";
    return text.str();
}

std::string sized(double width, double height, double pixelWidth, double pixelHeight) {
    return number("imageWidth", width) + number("imageHeight", height) + number("pixelWidth", pixelWidth) +
           number("pixelHeight", pixelHeight);
}

std::string called(const std::string& name) {
    return "<name type=\"String\">" + name + "</name>";
}

/// A file with a scan that a scanner made, at 7 8 9, and photos.
class FileWithPhotos {
  public:
    FileWithPhotos() {
        E57Scan scan;
        scan.fields = {E57Field::real("cartesianX"), E57Field::real("cartesianY"),
                       E57Field::real("cartesianZ")};
        scan.records = 3;
        scan.real = [](std::uint64_t record, std::size_t field) { return double(record + field); };
        scan.xml = e57Pose(std::sqrt(0.5), 0, 0, std::sqrt(0.5), 7, 8, 9);
        guid = writer_.add(scan);
    }
    std::uint64_t blob(std::string_view bytes) { return writer_.addBlob(bytes); }
    void add(const std::string& photo) { photos_ += photo; }
    std::string file() {
        writer_.finish("<images2D type=\"Vector\">\n" + photos_ + "</images2D>\n");
        return out_.str();
    }
    std::string guid;

  private:
    std::stringstream out_{std::ios::in | std::ios::out | std::ios::binary};
    E57Writer writer_{out_};
    std::string photos_;
};

void expectClose(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_NEAR(glm::distance(a, b), 0, 1e-12) << a.x << " " << a.y << " " << a.z;
}

TEST(E57Photos, ComeWithEveryByteAndWhatTheyShow) {
    FileWithPhotos made;
    const std::string jpeg = jpegBytes();
    const auto jpegAt = made.blob(jpeg), pngAt = made.blob(pngBytes);
    const auto jpegBlob = e57Blob("jpegImage", jpegAt, jpeg.size());
    const auto pngBlob = e57Blob("pngImage", pngAt, pngBytes.size());
    // A quarter turn about z, then moved: x becomes y.
    const auto pose = e57Pose(std::sqrt(0.5), 0, 0, std::sqrt(0.5), 1, 2, 3);
    const auto ofScan = "<associatedData3DGuid type=\"String\">" + made.guid + "</associatedData3DGuid>";
    made.add(e57Photo("sphericalRepresentation", jpegBlob,
                      sized(400, 200, glm::pi<double>() / 200, glm::pi<double>() / 200),
                      called("all around") + ofScan + pose));
    // Twice as far away as half of it is wide: 53.13°; as high as far away is its half: 90°.
    made.add(e57Photo("pinholeRepresentation", pngBlob,
                      sized(100, 200, 0.01, 0.01) + number("focalLength", 1), called("ahead") + pose));
    made.add(e57Photo("cylindricalRepresentation", pngBlob,
                      sized(100, 100, 0.01, 0.02) + number("radius", 1) + number("principalPointY", 50),
                      pose));
    made.add(e57Photo("visualReferenceRepresentation", pngBlob, sized(10, 20, 1, 1), called("look")));
    const auto result = imported(made.file());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->points.size(), 3U);
    EXPECT_THAT(result->notes, IsEmpty());
    ASSERT_EQ(result->photos.size(), 4U);
    const auto& [around, ahead, cylinder, look] =
        std::tie(result->photos[0], result->photos[1], result->photos[2], result->photos[3]);

    EXPECT_EQ(bytesOf(around), jpeg);
    EXPECT_EQ(around.name, "all around");
    EXPECT_EQ(around.format, Photo::Format::Jpeg);
    EXPECT_EQ(around.projection, Photo::Projection::Spherical);
    EXPECT_EQ(around.width, 400U);
    EXPECT_EQ(around.height, 200U);
    EXPECT_EQ(around.station, 0U) << "of the scan that it belongs to";
    EXPECT_NEAR(around.angles[0], 2 * glm::pi<double>(), 1e-9);
    EXPECT_NEAR(around.angles[1], glm::pi<double>(), 1e-9);
    ASSERT_TRUE(around.pose);
    expectClose(around.pose->position, {1, 2, 3});
    expectClose(around.pose->forwards, {0, 1, 0});
    expectClose(around.pose->up, {0, 0, 1});

    EXPECT_EQ(bytesOf(ahead), pngBytes);
    EXPECT_EQ(ahead.format, Photo::Format::Png);
    EXPECT_EQ(ahead.station, std::nullopt);
    EXPECT_NEAR(ahead.angles[0], 2 * std::atan(0.5), 1e-12);
    EXPECT_NEAR(ahead.angles[1], 2 * std::atan(1.0), 1e-12);
    ASSERT_TRUE(ahead.pose);
    expectClose(ahead.pose->forwards, {0, 0, -1});
    expectClose(ahead.pose->up, {-1, 0, 0});

    EXPECT_EQ(cylinder.projection, Photo::Projection::Cylindrical);
    EXPECT_NEAR(cylinder.angles[0], 1, 1e-12);
    EXPECT_NEAR(cylinder.angles[1], 2 * std::atan(1.0), 1e-12);
    ASSERT_TRUE(cylinder.pose);
    expectClose(cylinder.pose->forwards, {0, 1, 0});

    EXPECT_EQ(look.projection, Photo::Projection::Visual);
    EXPECT_EQ(look.name, "look");
    EXPECT_FALSE(look.pose);
}

// The pixel straight ahead is at the left edge, so the middle of the photo lies to the right, as far as half of it is wide.
TEST(E57Photos, OfWhichStraightAheadIsNotTheMiddleLookWhereTheirMiddleIs) {
    FileWithPhotos made;
    const auto blob = e57Blob("pngImage", made.blob(pngBytes), pngBytes.size());
    made.add(e57Photo("pinholeRepresentation", blob,
                      sized(200, 200, 0.01, 0.01) + number("focalLength", 1) + number("principalPointX", 0) +
                          number("principalPointY", 100),
                      e57Pose(1, 0, 0, 0, 0, 0, 0)));
    const auto result = imported(made.file());
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->photos.size(), 1U);
    ASSERT_TRUE(result->photos[0].pose);
    expectClose(result->photos[0].pose->forwards, {std::sqrt(0.5), 0, -std::sqrt(0.5)});
    expectClose(result->photos[0].pose->up, {0, 1, 0});
    EXPECT_NEAR(result->photos[0].angles[0], std::atan(2.0), 1e-12);
}

TEST(E57Photos, OfImpossibleCamerasHaveNoPose) {
    FileWithPhotos made;
    const auto blob = e57Blob("pngImage", made.blob(pngBytes), pngBytes.size());
    const auto pose = e57Pose(1, 0, 0, 0, 0, 0, 0);
    for (const char* focal : {"1e-200", "1e-8"})
        made.add(e57Photo("pinholeRepresentation", blob,
                          sized(200, 200, 1e-3, 1e-3) + "<focalLength>" + focal + "</focalLength>" +
                              number("principalPointX", 100) +
                              number("principalPointY", focal[3] == '2' ? 100 : 0),
                          pose));
    const auto result = imported(made.file());
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->photos.size(), 2U);
    for (const Photo& photo : result->photos) {
        EXPECT_TRUE(photo.data);
        EXPECT_FALSE(photo.pose);
    }
}

// A file of entries that all name the same bytes would fill any disk.
TEST(E57Photos, AreNotMoreThanTheirFile) {
    FileWithPhotos made;
    const std::string jpeg = jpegBytes(100'000);
    const auto blob = e57Blob("jpegImage", made.blob(jpeg), jpeg.size());
    for (int i = 0; i < 5; ++i) made.add(e57Photo("visualReferenceRepresentation", blob, ""));
    const auto result = imported(made.file());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->photos.size(), 1U);
    EXPECT_THAT(result->notes, ElementsAre("4 photos left out: together they have more bytes than the file"));
}

TEST(E57Photos, ThatCannotBeReadAreCountedAndCostNoPoint) {
    FileWithPhotos made;
    const std::string jpeg = jpegBytes(20'000);
    const auto good = made.blob(jpeg), text = made.blob("no picture at all"), broken = made.blob(jpeg);
    const auto photo = [](std::uint64_t at, std::size_t bytes) {
        return e57Photo("visualReferenceRepresentation", e57Blob("jpegImage", at, bytes), "");
    };
    made.add(photo(good, jpeg.size()));
    made.add(photo(text, 17));
    made.add(photo(good, 0));
    made.add(photo(std::uint64_t(1) << 60, 5));
    made.add(photo(good, std::size_t(1) << 40));
    made.add(photo(good, std::size_t(100) << 20));
    made.add(photo(broken, jpeg.size()));
    made.add("<vectorChild type=\"Structure\"/>\n");
    std::string file = made.file();
    file[(broken / 1024 + 5) * 1024 + 7] ^= 1;  // a page in the middle of it
    const auto result = imported(file);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->points.size(), 3U);
    EXPECT_THAT(result->notes,
                ElementsAre("1 entry for a photo that is not in it", "1 photo left out: it has no bytes",
                            "2 photos left out: its place in the file is none",
                            "1 photo left out: larger than 128 MiB", "1 photo left out: neither JPEG nor PNG",
                            "1 photo left out: unreadable"));
    ASSERT_EQ(result->photos.size(), 2U);
    EXPECT_EQ(bytesOf(result->photos[0]), jpeg);
    EXPECT_FALSE(result->photos[1].data);
}

}  // namespace
}  // namespace scancast::test
