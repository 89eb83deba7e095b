// Rasters over HTTP: the bytes of elevations that the renderer makes, sent block by block or packed; orthophotos of the pictures of one client;
// and what becomes of who leaves, asks for too much, or for what is damaged.
#include <cstring>
#include <nlohmann/json.hpp>

#include "client/cpp/scancast_client.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "renderer/raster/raster_tiff.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/access/guest_token.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/fake_cloud_file.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;

class RastersTest : public ServerTest {
  protected:
    void startWithSurvey() {
        start();
        std::vector<std::unique_ptr<PointSource>> sources;
        const auto make = [](std::uint64_t i, std::uint64_t n) {
            auto p = ground(i, n);
            p.classification = std::uint8_t(1 + i % 9);
            return p;
        };
        sources.push_back(std::make_unique<SyntheticSource>(
            sized(60'000, 8'000), make, Attributes{.color = true, .classification = true}, 0.001));
        const auto report =
            ingest(std::move(sources),
                   {.output = folder / "survey.scan", .shape = {.leafPoints = 4096, .chunkPoints = 50'000}});
        ASSERT_TRUE(report) << report.error().message;
        survey = *openCloud(folder / "survey.scan", cache);
        server->catalog().setReady(server->catalog().add("survey"), survey);
    }
    HttpReply get(const std::string& what, std::vector<std::string> headers = {},
                  const std::string& method = "GET") const {
        return request(port(), "/api/v1/clouds/" + what, headers, method);
    }
    /// What the renderer makes of it by itself.
    std::string made(const WordValues& words) const {
        const auto raster = planRaster(*survey, *rasterRequestOf(RasterKind::Elevation, words));
        EXPECT_TRUE(raster) << raster.error().message;
        auto tiff = openTiff(*survey, *raster, {folder.path(), "--here"});
        std::string bytes;
        while (!(*tiff)->isDone()) {
            while ((*tiff)->ready() > 0) {
                const auto part = (*tiff)->take(100'000);
                bytes.append(reinterpret_cast<const char*>(part->data()), part->size());
            }
            if (!(*tiff)->nextBlock()) continue;
            const auto cells = elevationCells(*survey, *raster, *(*tiff)->nextBlock());
            EXPECT_TRUE((*tiff)->put(*cells));
        }
        return bytes;
    }
    double held() const {
        const std::string start = "scancast_transient_bytes{use=\"answers\"}", line = metric(start);
        return line.empty() ? 0 : std::stod(line.substr(start.size()));
    }

    const TemporaryFolder folder;
    std::shared_ptr<BlockCache> cache =
        BlockCache::create({.memoryLimit = 64'000'000, .threads = 1, .onDamaged = {}});
    std::shared_ptr<const Cloud> survey;
};

TEST_F(RastersTest, ElevationsHaveTheBytesOfTheRenderers) {
    startWithSurvey();
    for (const char* packing : {"none", "deflate"}) {
        // Several blocks: 200 x 200 metres.
        const HttpReply reply =
            get(std::string("survey/dem.tif?cell=0.15&classes=2,3&value=mean&fill=2&compress=") + packing);
        ASSERT_EQ(reply.status, 200) << reply.body;
        EXPECT_TRUE(reply.whole);
        EXPECT_EQ(reply.header("content-type"), "image/tiff");
        EXPECT_EQ(reply.header("content-disposition"), "attachment; filename=\"survey-dem.tif\"");
        const json facts = json::parse(reply.header("scancast-raster"));
        EXPECT_GT(facts["columns"].get<int>(), 1024);
        EXPECT_EQ(facts["cell"], 0.15);
        EXPECT_TRUE(reply.body == made({{"cell", "0.15"},
                                        {"classes", "2,3"},
                                        {"value", "mean"},
                                        {"fill", "2"},
                                        {"compress", packing}}))
            << packing;
    }
    EXPECT_TRUE(eventually([&] { return held() == 0; }));
}

TEST_F(RastersTest, TagsAreKnownBeforeAnythingIsMade) {
    startWithSurvey();
    const std::string address = "survey/dem.tif?cell=1";
    const HttpReply reply = get(address);
    const std::string tag = reply.header("etag");
    ASSERT_FALSE(tag.empty());
    EXPECT_EQ(get(address, {"If-None-Match: " + tag}).status, 304);
    const HttpReply head = get(address, {}, "HEAD");
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.header("etag"), tag);
    for (const char* other : {"?cell=2", "?cell=1&value=mean", "?cell=1&fill=1", "?cell=1&classes=2",
                              "?cell=1&tile=512", "?cell=1&compress=none", "?cell=1&bbox=10,10,50,50"})
        EXPECT_NE(get(std::string("survey/dem.tif") + other, {}, "HEAD").header("etag"), tag) << other;
}

TEST_F(RastersTest, WhatCannotBeMadeIsRefusedInAWordThatSaysWhy) {
    startWithSurvey();
    EXPECT_EQ(get("nowhere/dem.tif").status, 404);
    EXPECT_EQ(get("survey/dem.tif", {"Accept: image/png"}).status, 406);
    const std::vector<std::string> wrong{"cell=0",
                                         "cell=inf",
                                         "cell=nan",
                                         "bbox=-inf,-inf,inf,inf",
                                         "bbox=-1e308,-1e308,1e308,1e308",
                                         "cell=-1",
                                         "cell=0.000001",
                                         "bbox=1,2,3",
                                         "bbox=900,900,1000,1000",
                                         "value=most",
                                         "fill=1e9",
                                         "eye=1,2,3",
                                         "colour=rgb",
                                         "color=rgb",
                                         "classes=x",
                                         "with=one",
                                         "tile=100",
                                         "compress=lzw",
                                         "cell=1&cell=2"};
    for (const std::string& words : wrong) {
        const HttpReply reply = get("survey/dem.tif?" + words);
        EXPECT_EQ(reply.status, 400) << words << reply.body;
        EXPECT_NE(reply.body.find(words.substr(0, words.find('='))), std::string::npos) << words;
    }
    const HttpReply row =
        get("survey/dem.tif?cell=0.0000002&bbox=10,10,200,10.0000002&compress=none&tile=512");
    EXPECT_EQ(row.status, 400) << "tiles are as high as wide: a row of cells is 512 of them";
    EXPECT_NE(row.body.find("with cell="), std::string::npos) << row.body;
    EXPECT_EQ(get("survey/ortho.tif?fill=1").status, 400);
    EXPECT_EQ(get("survey/ortho.tif?with=nowhere").status, 404);
    const std::string loading = server->catalog().add("loading");
    server->catalog().setPreview(loading, one);
    EXPECT_EQ(get(loading + "/dem.tif").status, 503) << "a coarse cloud is not all of it";
    EXPECT_EQ(post(port(), "/api/v1/clouds/survey/dem.tif", "{}", {"Content-Type: application/json"}).status,
              405);
}

TEST_F(RastersTest, OrthophotosAreTheClientsPicturesOneAfterTheOther) {
    startWithSurvey();
    painter.finishLate();
    const std::size_t before = painter.begun().size();
    const HttpReply reply = get("survey/ortho.tif?cell=0.05&compress=none&samples=1&color=elevation");
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_TRUE(reply.whole);
    const json facts = json::parse(reply.header("scancast-raster"));
    EXPECT_GT(reply.body.size(), 4 * facts["columns"].get<std::size_t>() * facts["rows"].get<std::size_t>());
    const auto begun = painter.begun();
    ASSERT_GE(begun.size() - before, 16U);
    for (std::size_t i = before; i < begun.size(); ++i) {
        EXPECT_EQ(begun[i].view.camera.projection, Projection::Orthographic);
        EXPECT_EQ(begun[i].view.style.background.kind, Background::Kind::Transparent);
        EXPECT_EQ(begun[i].view.width, begun[before].view.width) << "all of one size";
    }
    EXPECT_EQ(painter.mostAtOnce(), 1);
    const std::size_t after = painter.begun().size();
    EXPECT_EQ(get("survey/ortho.tif?cell=0.05&compress=none&samples=1&color=elevation",
                  {"If-None-Match: " + reply.header("etag")})
                  .status,
              304);
    EXPECT_EQ(painter.begun().size(), after);
    painter.damage(3);
    EXPECT_EQ(get("survey/ortho.tif?cell=1").status, 500)
        << "a picture that lacks blocks is none of the cloud";
}

TEST_F(RastersTest, WhoLeavesEndsTheWorkAndOneClientMayNotHaveItAll) {
    startWithSurvey();
    painter.closeGate();
    const auto ask = [&](RawSocket& socket) {
        return socket.send(
            "GET /api/v1/clouds/survey/ortho.tif?cell=0.5 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    };
    {
        RawSocket first(port()), second(port());
        ASSERT_TRUE(ask(first) && ask(second));
        ASSERT_TRUE(painter.waitBegun(1));
        EXPECT_TRUE(eventually([&] { return get("survey/ortho.tif?cell=0.5").status == 429; }));
        EXPECT_EQ(get("survey/ortho.tif?cell=0.5").header("retry-after"), "1");
    }
    EXPECT_TRUE(eventually([&] { return painter.cancelled() > 0; }));
    painter.openGate();
    EXPECT_TRUE(eventually([&] { return get("survey/ortho.tif?cell=0.5").status == 200; }));
    EXPECT_TRUE(eventually([&] { return held() == 0; }));
}

TEST_F(RastersTest, ADamagedBlockIsToldAtOnceOrCutsTheAnswerShort) {
    start();
    const auto file = std::make_shared<FakeCloudFile>(3, 4, 20'000);
    const auto cloud = openCloud(std::shared_ptr<const CloudFile>(file), cache);
    ASSERT_TRUE(cloud) << cloud.error().message;
    server->catalog().setReady(server->catalog().add("fake"), *cloud);
    ASSERT_EQ(get("fake/dem.tif").status, 200);
    for (std::uint32_t i = 0; i < file->nodes().size(); ++i)
        if (file->nodes()[i].node.isLeaf()) file->damage(i);
    const HttpReply told = get("fake/dem.tif");
    EXPECT_EQ(told.status, 500);
    EXPECT_EQ(told.body.find("byte 4711"), std::string::npos) << "where the file lies is not for everybody";
}

TEST_F(RastersTest, GuestsGetOrthophotosAndElevationsWhereTheyMay) {
    const NamedToken key{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"};
    options.tokens = {{{"user", "user-0123456789abcdef"}}, {}, {key}};
    for (const bool allowed : {false, true}) {
        options.guestsMayExport = allowed;
        server.reset();
        start();
        const auto until = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()) + 600;
        const std::string link =
            signedToken({key.name, "one", until, std::string(12, 'i'), std::nullopt}, key.token);
        const json pass = json::parse(post(port(), "/api/v1/guest-session", json{{"token", link}}.dump(),
                                           {"Content-Type: application/json"})
                                          .body);
        const std::vector<std::string> bearer{"Authorization: Bearer " + pass["token"].get<std::string>()};
        EXPECT_EQ(get("one/dem.tif", bearer).status, allowed ? 200 : 403);
        EXPECT_EQ(get("one/ortho.tif?cell=1", bearer).status, 200);
        EXPECT_EQ(get("two/ortho.tif?cell=1", bearer).status, 404);
        EXPECT_EQ(get("one/ortho.tif?cell=1").status, 401);
    }
}

TEST_F(RastersTest, TheClientLibraryHandsItOver) {
    startWithSurvey();
    const client::Server asked(*client::parseServerUrl(server->url()));
    std::string bytes;
    const client::TakeBytes take = [&](std::span<const std::byte> more) -> Expected<void> {
        bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
        return {};
    };
    const WordValues words{{"cell", "0.5"}, {"value", "lowest"}};
    const auto facts = asked.raster("survey", *rasterRequestOf(RasterKind::Elevation, words), take);
    ASSERT_TRUE(facts) << facts.error().message;
    EXPECT_TRUE(bytes == made(words));
    EXPECT_EQ(facts->bytes, bytes.size());
    EXPECT_EQ(facts->cell, 0.5);
    const auto refused =
        asked.raster("survey", *rasterRequestOf(RasterKind::Elevation, {{"cell", "0.00001"}}), take);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("with cell="), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace scancast::test
