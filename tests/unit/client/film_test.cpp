#include "client/cpp/program/film_writer.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "renderer/image/encode.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::client {
namespace {

class Film : public testing::Test {
  protected:
    std::string file(const std::string& name) const { return folder_.file(name); }

    static std::vector<std::uint8_t> picture(std::uint8_t grey) {
        Frame frame;
        frame.width = 33;  // odd: most pixel formats of videos want even sides
        frame.height = 25;
        frame.rgba.own().assign(33U * 25 * 4, grey);
        return encodeJpeg(frame, 90, Subsampling::S420).value();
    }

    const scancast::test::TemporaryFolder folder_;
};

TEST_F(Film, PicturesAreNumberedWithDigitsForAll) {
    auto writer = FilmWriter::create(file("a/b"), 1200, 30);
    ASSERT_TRUE(writer) << writer.error().message;
    ASSERT_TRUE(writer->add({1, 2, 3}));
    ASSERT_TRUE(writer->add({4}));
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(std::filesystem::file_size(folder_ / "a/b/frame-0001.jpg"), 3U);
    EXPECT_EQ(std::filesystem::file_size(folder_ / "a/b/frame-0002.jpg"), 1U);
}

// Oracle: ffprobe counts the frames of the video that is there afterwards.
TEST_F(Film, AVideoHasEveryPicture) {
    auto writer = FilmWriter::create(file("film.mp4"), 12, 24);
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < 12; ++i) ASSERT_TRUE(writer->add(picture(static_cast<std::uint8_t>(i * 20))));
    const auto finished = writer->finish();
    ASSERT_TRUE(finished) << finished.error().message;
    auto* probe = popen(("ffprobe -v error -count_frames -select_streams v:0 -show_entries "
                         "stream=nb_read_frames,r_frame_rate,width,height -of csv=p=0 '" +
                         file("film.mp4") + "'")
                            .c_str(),
                        "r");
    ASSERT_TRUE(probe);
    char text[200] = {};
    EXPECT_TRUE(fgets(text, sizeof text, probe));
    EXPECT_EQ(pclose(probe), 0);
    EXPECT_STREQ(text, "34,26,24/1,12\n");
}

TEST_F(Film, WhatFfmpegCannotMakeIsAnError) {
    auto writer = FilmWriter::create(file("no/such/folder/film.mp4"), 2, 24);
    ASSERT_TRUE(writer) << writer.error().message;
    Expected<void> result;
    for (int i = 0; i < 2 && result; ++i) result = writer->add(picture(9));
    if (result) result = writer->finish();
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().message.find("film.mp4"), std::string::npos) << result.error().message;
}

TEST_F(Film, AFolderThatCannotBeIsAnError) {
    std::ofstream(file("taken")) << "a file";
    EXPECT_FALSE(FilmWriter::create(file("taken/frames"), 2, 24));
    EXPECT_TRUE(isVideo("a.mp4") && isVideo("b/c.webm") && isVideo("A.MP4"));
    EXPECT_FALSE(isVideo("mp4") || isVideo("frames/"));
}

TEST_F(Film, ANameThatAsksForAnotherKindIsNoFolder) {
    for (const char* name : {"x.gif", "x.GIF", "a.b/x.png", "x.m4v", ".x.jpeg"}) {
        const auto refused = checkFilmName(file(name));
        ASSERT_FALSE(refused) << name;
        EXPECT_NE(refused.error().message.find("frames/"), std::string::npos) << refused.error().message;
    }
    for (const char* name : {"frames", "frames/", "x.gif/", "v1.2", "x.mp4", "x.Mov", ".gif"})
        EXPECT_TRUE(checkFilmName(file(name))) << name;
    std::filesystem::create_directory(file("old.gif"));
    EXPECT_TRUE(checkFilmName(file("old.gif"))) << "it is a folder already";
}

}  // namespace
}  // namespace scancast::client
