// `scancast serve` and `render` of cloud files, as people run them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "protocol/frame_header.hpp"
#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

class CloudFileProgram : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        ASSERT_EQ(run({"scancast", "generate", "town", "--points", "300000", "-q", "-o", file("town.las")}),
                  0)
            << lastError;
        ASSERT_EQ(run({"scancast", "ingest", file("town.las"), "--no-surfels", "-o", file("town.scan"),
                       "--title", "town"}),
                  0)
            << lastError;
    }
};

// Right because one was read from a file block by block, the other built in memory from the scan.
TEST_F(CloudFileProgram, RendersAsTheScanDoes) {
    for (const char* name : {"town.las", "town.scan"})
        ASSERT_EQ(run({"scancast", "render", file(name), "--no-surfels", "--backend", "cpu", "--width", "320",
                       "--height", "200", "-o", file(std::string(name) + ".png")}),
                  0)
            << lastError;
    EXPECT_TRUE(contentOf(file("town.las.png")) == contentOf(file("town.scan.png")));
}

TEST_F(CloudFileProgram, IsServedWithinALimitAndItsFinalStillIsTheSnapshot) {
    const auto server = serve({file("town.scan"), "--memory-limit", "64M"});
    const auto cloud = nlohmann::json::parse(request(port, "/api/v1/clouds/town").body);
    EXPECT_EQ(cloud["state"], "ready");
    EXPECT_EQ(cloud["points"], 300000);
    EXPECT_TRUE(cloud["columns"].is_array());
    RawWebSocket stream(port);
    stream.text(R"({"type":"hello","width":240,"height":160})");
    std::string picture;
    ASSERT_NO_FATAL_FAILURE(receiveFinal(stream, 0, picture));
    EXPECT_TRUE(picture == request(port, "/api/v1/clouds/town/snapshot.jpg?width=240&height=160").body);
    const std::string metrics = request(port, "/metrics").body;
    EXPECT_THAT(metrics, HasSubstr("scancast_residency_limit_bytes 41943040"));
    EXPECT_THAT(metrics, HasSubstr("scancast_transient_limit_bytes 25165824")) << "64M together";
    EXPECT_THAT(metrics, HasSubstr("scancast_block_load_errors_total 0"));
    EXPECT_THAT(metrics, ::testing::Not(HasSubstr("scancast_blocks_loaded_total 0\n")));
}

TEST_F(CloudFileProgram, WhatServeKeepsIsThereTheNextTime) {
    fs::create_directories(folder / "kept");
    std::string first;
    for (int start = 0; start < 2; ++start) {
        const auto server = serve({file("town.las"), "--cache-dir", file("kept")});
        const std::string picture =
            request(port, "/api/v1/clouds/town/snapshot.jpg?width=160&height=120").body;
        ASSERT_FALSE(picture.empty());
        if (start == 0) first = picture;
        EXPECT_TRUE(picture == first);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder / "kept"), {}), 1);
        server->signal(SIGTERM);
        EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0);
    }
}

// Bytes are turned all over the file: most of it are leaves' samples, which this view draws all of.
TEST_F(CloudFileProgram, SaysWhatItLacksAndShowsTheWholeFileThatTakesItsPlace) {
    fs::copy_file(file("town.scan"), file("whole.scan"));
    {
        std::fstream bytes(file("town.scan"), std::ios::binary | std::ios::in | std::ios::out);
        for (int i = 1; i < 12; ++i) {
            const auto at = std::streamoff(fs::file_size(file("town.scan")) * i / 16);
            bytes.seekg(at);
            const char turned = char(~bytes.get());
            bytes.seekp(at);
            bytes.put(turned);
        }
    }
    const auto server = serve({file("town.scan")});
    const std::string target = "/api/v1/clouds/town/snapshot.jpg?width=240&height=160&detail=0";
    const HttpReply damaged = request(port, target);
    ASSERT_EQ(damaged.status, 200);
    ASSERT_FALSE(damaged.header("scancast-damaged").empty());
    EXPECT_GE(std::stoi(damaged.header("scancast-damaged")), 1);
    EXPECT_LE(std::stoi(damaged.header("scancast-damaged")), 11);
    EXPECT_EQ(damaged.header("cache-control"), "no-store");
    EXPECT_EQ(damaged.header("etag"), "");
    EXPECT_TRUE(request(port, target).body == damaged.body);
    EXPECT_THAT(server->err(), HasSubstr("; coarser points are shown in its place"));
    EXPECT_EQ(run({"scancast-client", "snapshot", url, "--detail", "0", "-o", file("a.jpg")}), 0);
    EXPECT_THAT(lastError, HasSubstr("of this cloud cannot be read"));

    RawWebSocket stream(port);
    stream.text(R"({"type":"hello","width":240,"height":160})");
    stream.text(R"({"type":"view","seq":1,"detail":0})");
    std::string picture;
    FrameHeader header;
    ASSERT_NO_FATAL_FAILURE(receiveFinal(stream, 1, picture, &header));
    EXPECT_TRUE(header.still && header.damaged);
    EXPECT_TRUE(picture == damaged.body);

    fs::rename(file("whole.scan"), file("town.scan"));
    ASSERT_NO_FATAL_FAILURE(receiveFinal(stream, 1, picture, &header));
    EXPECT_FALSE(header.damaged);
    const HttpReply whole = request(port, target);
    EXPECT_FALSE(whole.header("etag").empty());
    EXPECT_EQ(whole.header("scancast-damaged"), "");
    EXPECT_TRUE(picture == whole.body);
    EXPECT_THAT(server->err(), HasSubstr("town.scan has been replaced"));
}

TEST_F(CloudFileProgram, DamagedAndImpossibleRequestsSayWhy) {
    fs::resize_file(folder / "town.scan", fs::file_size(folder / "town.scan") / 2);
    EXPECT_EQ(run({"scancast", "render", file("town.scan"), "-o", file("a.png")}), 1);
    EXPECT_THAT(lastError, HasSubstr("town.scan"));
    EXPECT_EQ(run({"scancast", "serve", file("town.las"), "--memory-limit", "plenty"}), 1);
    EXPECT_THAT(lastError, HasSubstr("memory-limit"));
    EXPECT_EQ(run({"scancast", "serve", file("town.las"), "--cache-dir", file("nowhere")}), 1);
    EXPECT_THAT(lastError, HasSubstr("nowhere"));
    const auto server = serve({file("town.scan"), file("town.las")});
    const auto list = nlohmann::json::parse(request(port, "/api/v1/clouds").body);
    ASSERT_EQ(list["pending"].size(), 1U);
    EXPECT_EQ(list["pending"][0]["state"], "failed");
    const std::string why = list["pending"][0]["error"];
    EXPECT_THAT(why, HasSubstr("town.scan"));
    EXPECT_THAT(why, ::testing::Not(HasSubstr(folder.path().string())));
}

}  // namespace
}  // namespace scancast::test
