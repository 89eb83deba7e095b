// Stations of the point stream: what is written is what is read, and each chunk knows where it was recorded from.
#include <gmock/gmock.h>

#include "tests/unit/import/small_stream.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

const Station tower{
    .name = "Tower, east", .position = {389500.1, -1.0 / 3, 1e-9}, .forwards = glm::dvec3(0, 0.6, 0.8)};
const Station nameless{.position = {4, 5, 6}};

TEST(PointStreamStations, EachChunkKnowsWhereItWasRecordedFrom) {
    SmallStream stream;
    ASSERT_TRUE(stream.writer.writeStation(tower));
    ASSERT_TRUE(stream.writer.writeStation(nameless));
    stream.chunk(2);
    ASSERT_TRUE(stream.writer.writeFrom(1));
    stream.chunk(3);
    ASSERT_TRUE(stream.writer.writeNote("in between"));
    stream.chunk(4);
    ASSERT_TRUE(stream.writer.writeFrom(0));
    stream.chunk(5);
    ASSERT_TRUE(stream.writer.writeFrom(std::nullopt));
    stream.chunk(6);
    ASSERT_TRUE(stream.writer.writeFrom(1));
    stream.chunk(7);
    ASSERT_TRUE(stream.writer.finish(0));

    const auto reader = stream.open();
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->stations(), (std::vector<Station>{tower, nameless})) << "before a point is read";
    std::vector<std::pair<std::size_t, std::optional<glm::dvec3>>> seen;
    PointBatch batch;
    while ((*reader)->read(batch).value()) seen.emplace_back(batch.size(), batch.scanner);
    EXPECT_EQ(seen, (std::vector<std::pair<std::size_t, std::optional<glm::dvec3>>>{{2, std::nullopt},
                                                                                    {3, nameless.position},
                                                                                    {4, nameless.position},
                                                                                    {5, tower.position},
                                                                                    {6, std::nullopt},
                                                                                    {7, nameless.position}}));
    EXPECT_EQ((*reader)->stations()[0].points, 5U);
    EXPECT_EQ((*reader)->stations()[1].points, 14U);
}

TEST(PointStreamStations, WhatIsWrongWithThemIsSaid) {
    struct Lie {
        const char* text;
        const char* reason;
    };
    for (const Lie& lie :
         {Lie{"{", "no JSON object"}, Lie{"[]", "no JSON object"},
          Lie{"{\"name\": \"a\"}", "it has no position"}, Lie{R"({"position": [1, 2]})", "not three numbers"},
          Lie{R"({"position": [1, 2, "3"]})", "not three numbers"},
          Lie{R"({"position": [1, 2, 1e999]})", "a station of its point stream is wrong"},
          Lie{R"({"position": [1, 2, 3], "name": 7})", "its name is no text"},
          Lie{R"({"position": [1, 2, 3], "forwards": [1, 1, 1]})", "no unit vector"},
          Lie{R"({"position": [1, 2, 3], "forwards": [0, 0, 0]})", "no unit vector"},
          Lie{R"({"position": [1, 2, 3], "mood": 1})", "\"mood\" is not known"}}) {
        SmallStream stream;
        const std::string_view text = lie.text;
        stream.raw("STND", std::uint32_t(text.size()), text);
        stream.chunk(1);
        EXPECT_THAT(stream.error(), HasSubstr(lie.reason)) << text;
    }
    SmallStream empty, large, nobody;
    empty.raw("STND", 0);
    EXPECT_THAT(empty.error(), HasSubstr("a station of 0 bytes"));
    large.raw("STND", 4097, std::string(4097, ' '));
    EXPECT_THAT(large.error(), HasSubstr("a station of 4,097 bytes"));
    ASSERT_TRUE(nobody.writer.writeStation(tower));
    nobody.raw("FROM", 1);
    EXPECT_THAT(nobody.error(), HasSubstr("points from station 1, of 1"));
    SmallStream first(false);
    ASSERT_TRUE(first.writer.writeStation(tower));
    EXPECT_THAT(first.error(), HasSubstr("a record of unknown kind")) << "version 1 has none";
}

TEST(PointStreamStations, LongNamesAreCutAndHostileOnesPrintable) {
    SmallStream stream;
    ASSERT_TRUE(stream.writer.writeStation({.name = std::string(5000, 'x')}));
    stream.raw("STND", 49, "{\"position\":[0,0,0],\"name\":\"\\u001b[2Jcleared!!!\"}");
    stream.chunk(1);
    ASSERT_TRUE(stream.writer.finish(0));
    const auto reader = stream.open();
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->stations()[0].name, std::string(longestStationName, 'x'));
    EXPECT_EQ((*reader)->stations()[1].name.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace scancast::test
