// Photos of the point stream: what is written is what is read, to the last byte, whoever wants them and whoever does not.
#include <gmock/gmock.h>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/import/small_stream.hpp"

namespace scancast::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Longer than a piece that is read at once.
std::vector<std::byte> jpeg(std::size_t size = 600'000) {
    std::vector<std::byte> bytes{std::byte{0xff}, std::byte{0xd8}, std::byte{0xff}};
    while (bytes.size() < size) bytes.push_back(std::byte((bytes.size() * bytes.size()) >> 9));
    return bytes;
}

Photo photoOf(std::span<const std::byte> bytes) {
    return {.name = "Chor, Straße",
            .projection = Photo::Projection::Spherical,
            .width = 8000,
            .height = 4000,
            .pose = Photo::Pose{{389500.1, -1.0 / 3, 1e-9}, {0, 0.6, 0.8}, {1, 0, 0}},
            .angles = {6.25, 3.125},
            .station = 0,
            .bytes = bytes.size()};
}

struct PhotoStream : SmallStream {
    PhotoStream() { EXPECT_TRUE(writer.writeStation({.name = "Tower"})); }
    void pixels(std::uint32_t index, std::span<const std::byte> bytes) {
        EXPECT_TRUE(writer.startPhotoBytes(index));
        EXPECT_TRUE(writer.writePhotoPiece(bytes.first(bytes.size() / 3)));
        EXPECT_TRUE(writer.writePhotoPiece(bytes.subspan(bytes.size() / 3)));
    }
};

std::size_t pointsOf(PointStreamReader& reader) {
    std::size_t points = 0;
    PointBatch batch;
    for (;;) {
        const auto more = reader.read(batch);
        EXPECT_TRUE(more) << more.error().message;
        if (!more || !*more) return points;
        points += batch.size();
    }
}

TEST(PointStreamPhotos, AreDescribedFirstAndThereAtTheEnd) {
    const auto first = jpeg(), second = jpeg(5);
    PhotoStream stream;
    ASSERT_TRUE(stream.writer.writePhoto(photoOf(first)));
    ASSERT_TRUE(stream.writer.writePhoto({.bytes = second.size()}));
    stream.chunk(2);
    stream.pixels(1, second);
    stream.chunk(3);
    stream.pixels(0, first);
    ASSERT_TRUE(stream.writer.finish(0));

    const TemporaryFolder folder;
    std::vector<Photo> kept;
    {
        const auto reader = stream.open({.photos = folder.path()});
        ASSERT_TRUE(reader) << reader.error().message;
        ASSERT_EQ((*reader)->photos().size(), 2U) << "before a point is read";
        EXPECT_EQ(point_stream::encodePhoto((*reader)->photos()[0]),
                  point_stream::encodePhoto(photoOf(first)));
        EXPECT_EQ(pointsOf(**reader), 5U);
        EXPECT_THAT((*reader)->notes(), IsEmpty());
        kept = (*reader)->photos();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "what they wait in has no name";
    ASSERT_TRUE(kept[0].data && kept[1].data);
    EXPECT_EQ(kept[0].data->read().value(), first) << "longer than their reader";
    EXPECT_EQ(kept[1].data->read().value(), second);

    const auto unwanted = stream.open();
    ASSERT_TRUE(unwanted);
    EXPECT_EQ(pointsOf(**unwanted), 5U);
    EXPECT_THAT((*unwanted)->notes(), IsEmpty());
    EXPECT_FALSE((*unwanted)->photos()[0].data);
}

TEST(PointStreamPhotos, ThatAreLostCostNoPointAndAreCounted) {
    const auto bytes = jpeg(100);
    PhotoStream stream;
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(stream.writer.writePhoto(photoOf(bytes)));
    stream.pixels(0, bytes);
    stream.pixels(1, bytes);
    stream.chunk(2);
    ASSERT_TRUE(stream.writer.finish(0));
    const auto reader = stream.open({.photos = "/nowhere/at/all"});
    ASSERT_TRUE(reader);
    EXPECT_EQ(pointsOf(**reader), 2U);
    EXPECT_THAT((*reader)->notes(), ElementsAre("2 photos left out: nothing can be written to the folder for "
                                                "temporary files (--scratch, or TMPDIR)",
                                                "1 photo left out: unreadable"));
}

// Photos that share their bytes in the file would fill any disk.
TEST(PointStreamPhotos, AreNotMoreThanTheirFile) {
    PhotoStream stream;
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(stream.writer.writePhoto({.bytes = 50}));
    stream.chunk(1);
    EXPECT_TRUE(stream.open({.mostPhotoBytes = 100}));
    const auto less = stream.open({.mostPhotoBytes = 99});
    ASSERT_FALSE(less);
    EXPECT_THAT(less.error().message, HasSubstr("photos of more bytes than its file has"));
}

TEST(PointStreamPhotos, WhatIsWrongWithThemIsSaid) {
    const std::string sound = R"("format": "png", "projection": "visual", "bytes": 9)";
    const std::pair<std::string, const char*> lies[] = {
        {"{", "no JSON object"},
        {"[]", "no JSON object"},
        {R"({"projection": "visual", "bytes": 9})", "it has no format"},
        {R"({"format": "png", "bytes": 9})", "it has no projection"},
        {R"({"format": "png", "projection": "visual"})", "how many bytes"},
        {R"({"format": "gif", "projection": "visual", "bytes": 9})", "its \"format\" is none"},
        {R"({"format": "png", "projection": "fisheye", "bytes": 9})", "its \"projection\" is none"},
        {R"({"format": "png", "projection": "visual", "bytes": 134217729})", "its \"bytes\" is none"},
        {"{" + sound + R"(, "station": 1})", "from station 1, of 1"},
        {"{" + sound + R"(, "station": -1})", "its \"station\" is none"},
        {"{" + sound + R"(, "width": 1.5})", "its \"width\" is none"},
        {"{" + sound + R"(, "angles": [7, 1]})", "its \"angles\" is none"},
        {"{" + sound + R"(, "angles": [1]})", "its \"angles\" is none"},
        {"{" + sound + R"(, "name": 7})", "its \"name\" is none"},
        {"{" + sound + R"(, "position": [1, 2, 3]})", "position, forwards and up together"},
        {"{" + sound + R"(, "position": [0,0,0], "forwards": [1,0,0], "up": [1,0,0]})", "at right angles"},
        {"{" + sound + R"(, "position": [0,0,0], "forwards": [2,0,0], "up": [0,1,0]})", "no unit vectors"},
        {"{" + sound + R"(, "mood": 1})", "\"mood\" is not known"},
    };
    for (const auto& [text, reason] : lies) {
        PhotoStream stream;
        stream.raw("PICT", std::uint32_t(text.size()), text);
        stream.chunk(1);
        EXPECT_THAT(stream.error(), HasSubstr(reason)) << text;
    }
    PhotoStream large, nobody, twice, other;
    large.raw("PICT", 4097, std::string(4097, ' '));
    EXPECT_THAT(large.error(), HasSubstr("a photo whose description has 4,097 bytes"));
    nobody.raw("PIXL", 0);
    EXPECT_THAT(nobody.error(), HasSubstr("the bytes of photo 0, of 0"));
    ASSERT_TRUE(twice.writer.writePhoto({.bytes = 9}));
    for (int i = 0; i < 2; ++i) twice.pixels(0, jpeg(9));
    EXPECT_THAT(twice.error(), HasSubstr("photo 0 for the second time"));
    ASSERT_TRUE(other.writer.writePhoto({.format = Photo::Format::Png, .bytes = 9}));
    other.pixels(0, jpeg(9));
    EXPECT_THAT(other.error(), HasSubstr("photo 0 is no png"));
    SmallStream first(false);
    ASSERT_TRUE(first.writer.writePhoto({.bytes = 9}));
    EXPECT_THAT(first.error(), HasSubstr("a record of unknown kind")) << "version 1 has none";
}

}  // namespace
}  // namespace scancast::test
