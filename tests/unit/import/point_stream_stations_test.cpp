// Stations of the point stream: what is written is what is read, and each chunk knows where it was recorded from.
#include <gmock/gmock.h>

#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

struct StationStream {
    std::vector<std::byte> bytes;
    PointStreamWriter writer{[this](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }};

    explicit StationStream(bool newest = true) {
        ScanHeader header;
        header.format = "TEST 1";
        EXPECT_TRUE(writer.writeHeader(header, newest));
    }
    void chunk(std::size_t n) {
        PointBatch batch;
        for (std::size_t i = 0; i < n; ++i) batch.position.emplace_back(1, 2, double(i));
        EXPECT_TRUE(writer.writeChunk(batch));
    }
    /// A record with any head and content.
    void raw(std::string_view tag, std::uint32_t n, std::string_view content = {}) {
        for (const char c : tag) bytes.push_back(std::byte(c));
        for (int i = 0; i < 4; ++i) bytes.push_back(std::byte(n >> (8 * i)));
        for (const char c : content) bytes.push_back(std::byte(c));
    }
    Expected<std::unique_ptr<PointStreamReader>> open() const {
        return PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false));
    }
    /// The error that it ends with.
    std::string error() const {
        auto reader = open();
        if (!reader) return reader.error().message;
        PointBatch batch;
        for (;;) {
            const auto more = (*reader)->read(batch);
            if (!more) return more.error().message;
            if (!*more) return "none";
        }
    }
};

const Station tower{
    .name = "Tower, east", .position = {389500.1, -1.0 / 3, 1e-9}, .forwards = glm::dvec3(0, 0.6, 0.8)};
const Station nameless{.position = {4, 5, 6}};

TEST(PointStreamStations, EachChunkKnowsWhereItWasRecordedFrom) {
    StationStream stream;
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
        StationStream stream;
        const std::string_view text = lie.text;
        stream.raw("STND", std::uint32_t(text.size()), text);
        stream.chunk(1);
        EXPECT_THAT(stream.error(), HasSubstr(lie.reason)) << text;
    }
    StationStream empty, large, nobody;
    empty.raw("STND", 0);
    EXPECT_THAT(empty.error(), HasSubstr("a station of 0 bytes"));
    large.raw("STND", 4097, std::string(4097, ' '));
    EXPECT_THAT(large.error(), HasSubstr("a station of 4,097 bytes"));
    ASSERT_TRUE(nobody.writer.writeStation(tower));
    nobody.raw("FROM", 1);
    EXPECT_THAT(nobody.error(), HasSubstr("points from station 1, of 1"));
    StationStream first(false);
    ASSERT_TRUE(first.writer.writeStation(tower));
    EXPECT_THAT(first.error(), HasSubstr("a record of unknown kind")) << "version 1 has none";
}

TEST(PointStreamStations, LongNamesAreCutAndHostileOnesPrintable) {
    StationStream stream;
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
