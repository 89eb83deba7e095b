// Points over HTTP: the bytes that `scancast export` would write, in chunks; and what becomes of who reads slowly, leaves, asks
// for too much, or for what is damaged.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "client/cpp/scancast_client.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/export/export_points.hpp"
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

class PointsTest : public ServerTest {
  protected:
    static constexpr std::uint64_t points = sized(60'000, 8'000);

    /// A survey of 200 x 200 metres on a grid, ingested.
    static std::shared_ptr<const CloudFile> surveyIn(const TemporaryFolder& folder) {
        const auto make = [](std::uint64_t i, std::uint64_t n) {
            auto p = ground(i, n);
            p.intensity = std::uint16_t(i * 7);
            p.classification = std::uint8_t(1 + i % 9);
            return p;
        };
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<SyntheticSource>(
            points, make, Attributes{.color = true, .intensity = true, .classification = true}, 0.001));
        const auto report =
            ingest(std::move(sources),
                   {.output = folder / "survey.scan", .shape = {.leafPoints = 4096, .chunkPoints = 50'000}});
        EXPECT_TRUE(report) << report.error().message;
        return *CloudFile::open(folder / "survey.scan");
    }
    void add(const std::string& id, const std::shared_ptr<const CloudFile>& file) {
        const auto cloud = openCloud(file, cache);
        ASSERT_TRUE(cloud) << cloud.error().message;
        server->catalog().setReady(server->catalog().add(id), *cloud);
    }
    void startWithSurvey() {
        start();
        survey = surveyIn(folder);
        add("survey", survey);
    }
    HttpReply ask(const json& body, const std::string& what = "points", const std::string& id = "survey",
                  std::vector<std::string> headers = {}) const {
        headers.push_back(sendsJson);
        return post(port(), "/api/v1/clouds/" + id + "/" + what, body.dump(), headers);
    }
    std::string exported(PointsFormat format, const PointsRegion& region = {},
                         std::shared_ptr<const Corridor> corridor = {}) const {
        const auto report = exportCloud(survey, {.output = folder.file("out"),
                                                 .format = format,
                                                 .region = region,
                                                 .corridor = std::move(corridor)});
        EXPECT_TRUE(report) << report.error().message;
        return contentOf(folder / "out");
    }
    /// Bytes of answers, as /metrics has them.
    double held() const {
        const std::string start = "scancast_transient_bytes{use=\"answers\"}", line = metric(start);
        return line.empty() ? 0 : std::stod(line.substr(start.size()));
    }
    static std::string requestFor(const std::string& target, const json& body,
                                  const std::string& version = "1.1") {
        const std::string text = body.dump();
        return "POST " + target + " HTTP/" + version + "\r\nHost: localhost\r\n" + sendsJson +
               "\r\nContent-Length: " + std::to_string(text.size()) + "\r\n\r\n" + text;
    }

    const TemporaryFolder folder;
    std::shared_ptr<BlockCache> cache =
        BlockCache::create({.memoryLimit = 64'000'000, .threads = 1, .onDamaged = {}});
    std::shared_ptr<const CloudFile> survey;
};

// Right because the command's own tests hold what it writes against brute force.
TEST_F(PointsTest, AnAnswerHasTheBytesOfAnExport) {
    startWithSurvey();
    const json region{{"clip", {{"min", {20, 30, -50}}, {"max", {150, 120, 50}}}},
                      {"classes", {2, 5}},
                      {"polygon", {{0, 0}, {180, 20}, {100, 190}}},
                      {"z", {-4, 4}}};
    PointsRegion same;
    same.clip = ClipBox{{20, 30, -50}, {150, 120, 50}};
    same.classes.emplace().set(2).set(5);
    same.polygon = PlanPolygon{{0, 0}, {180, 20}, {100, 190}};
    same.z = {-4, 4};
    for (const PointsFormat format :
         {PointsFormat::Las, PointsFormat::Ply, PointsFormat::Csv, PointsFormat::Text}) {
        const std::string form(name(format));
        const HttpReply all = ask({{"format", form}});
        ASSERT_EQ(all.status, 200) << all.body;
        EXPECT_TRUE(all.whole);
        EXPECT_EQ(all.header("scancast-points"), std::to_string(points));
        EXPECT_EQ(all.header("content-disposition"), "attachment; filename=\"survey." + form + "\"");
        EXPECT_EQ(all.header("cache-control"), "no-store");
        EXPECT_TRUE(all.body == exported(format)) << form;
        const HttpReply part = ask({{"format", form}, {"region", region}});
        ASSERT_EQ(part.status, 200) << part.body;
        EXPECT_TRUE(part.whole && part.body == exported(format, same)) << form;
        EXPECT_EQ(part.header("content-disposition"), "attachment; filename=\"survey-part." + form + "\"");
        EXPECT_EQ(part.header("scancast-points").empty(),
                  format == PointsFormat::Csv || format == PointsFormat::Text);
    }
}

TEST_F(PointsTest, AConnectionGoesOnAfterwards) {
    startWithSurvey();
    RawSocket socket(port());
    for (int time = 0; time < 2; ++time) {
        ASSERT_TRUE(socket.send(requestFor("/api/v1/clouds/survey/points", {{"format", "ply"}})));
        const HttpReply reply = readReply(socket);
        EXPECT_EQ(reply.status, 200);
        EXPECT_TRUE(reply.whole);
    }
    EXPECT_EQ(requestOn(socket, "/healthz").status, 200);
}

TEST_F(PointsTest, AProfileIsItsCorridorsPointsAndItsPictureSaysWhatItShows) {
    startWithSurvey();
    const json line{{"line", {{10, 10}, {150, 20}, {160, 180}}}, {"width", 4}};
    const auto corridor = Corridor::create({{10, 10}, {150, 20}, {160, 180}}, 4);
    ASSERT_TRUE(corridor);
    const HttpReply csv = ask(line, "profile");
    ASSERT_EQ(csv.status, 200) << csv.body;
    EXPECT_TRUE(csv.body == exported(PointsFormat::Csv, {}, std::make_shared<const Corridor>(*corridor)));
    EXPECT_TRUE(csv.body.starts_with("x,y,z,red,green,blue,intensity,classification,station,offset\n"));
    EXPECT_DOUBLE_EQ(json::parse(csv.header("scancast-profile"))["length"].get<double>(), corridor->length());
    const HttpReply png = ask(line, "profile", "survey", {"Accept: image/png"});
    ASSERT_EQ(png.status, 200) << png.body;
    EXPECT_EQ(png.header("content-type"), "image/png");
    EXPECT_TRUE(png.body.starts_with("\x89PNG"));
    const json facts = json::parse(png.header("scancast-profile"));
    EXPECT_EQ(facts["points"].get<long>(), std::count(csv.body.begin(), csv.body.end(), '\n') - 1);
    EXPECT_EQ(facts["left"], 0);
    EXPECT_GE(facts["right"].get<double>(), corridor->length());
    EXPECT_LE(facts["bottom"].get<double>(), facts["heights"][0].get<double>());
    EXPECT_GE(facts["top"].get<double>(), facts["heights"][1].get<double>());
    // As often as one likes: the memory of one is free when it has arrived.
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(ask(line, "profile", "survey", {"Accept: image/png"}).body, png.body);
    json byDepth = line;
    byDepth["format"] = "png";
    byDepth["picture"] = {{"color", "depth"}};
    EXPECT_EQ(ask(byDepth, "profile").status, 422);
}

TEST_F(PointsTest, ACloudInMemoryHasWhatItsSamplesHave) {
    start();
    const HttpReply reply = ask({{"format", "csv"}}, "points", "one");
    EXPECT_EQ(reply.status, 200);
    EXPECT_TRUE(reply.body.starts_with("x,y,z,red,green,blue,intensity,classification")) << reply.body;
    EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 2);
    server->catalog().setReady(server->catalog().add("elsewhere"), coldCloud());
    const HttpReply refused = ask(json::object(), "points", "elsewhere");
    EXPECT_EQ(refused.status, 422);
    EXPECT_NE(refused.body.find("other processes"), std::string::npos) << refused.body;
}

TEST_F(PointsTest, WhatCannotBeGivenIsRefusedInAWordThatSaysWhy) {
    startWithSurvey();
    EXPECT_EQ(ask({{"region", {{"z", {1000, 2000}}}}}).status, 422);
    const HttpReply empty = ask({{"format", "csv"}, {"region", {{"z", {1000, 2000}}}}});
    EXPECT_EQ(empty.status, 422);
    EXPECT_EQ(json::parse(empty.body)["type"], "urn:scancast:problem:empty");
    EXPECT_EQ(ask({{"line", {{-50, -50}, {-40, -50}}}, {"format", "png"}}, "profile").status, 422);
    EXPECT_EQ(ask({{"format", "laz"}}).status, 400);
    EXPECT_EQ(ask(json::object(), "points", "nowhere").status, 404);
    EXPECT_EQ(ask(json::object(), "points", "survey", {"Accept: image/png"}).status, 406);
    const std::string loading = server->catalog().add("loading");
    server->catalog().setPreview(loading, one);
    EXPECT_EQ(ask(json::object(), "points", loading).status, 503) << "a coarse cloud is not all of it";
    RawSocket old(port());
    old.send(requestFor("/api/v1/clouds/survey/points", json::object(), "1.0"));
    EXPECT_EQ(readReply(old).status, 505);
}

TEST_F(PointsTest, GuestsGetPicturesAndPointsWhereTheyMay) {
    const NamedToken key{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"};
    options.tokens = {{{"user", "user-0123456789abcdef"}}, {}, {key}};
    for (const bool allowed : {false, true}) {
        options.guestsMayExport = allowed;
        server.reset();
        start();
        const auto until = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()) + 600;
        const std::string link =
            signedToken({key.name, "one", until, std::string(12, 'i'), std::nullopt}, key.token);
        const json pass = json::parse(
            post(port(), "/api/v1/guest-session", json{{"token", link}}.dump(), {sendsJson}).body);
        const std::vector<std::string> bearer{"Authorization: Bearer " + pass["token"].get<std::string>()};
        EXPECT_EQ(pass["mayExport"], allowed) << "what the page offers goes by that";
        EXPECT_EQ(ask(json::object(), "points", "one", bearer).status, allowed ? 200 : 403);
        json line{{"line", {{-1, 0}, {3, 0}}}};
        EXPECT_EQ(ask(line, "profile", "one", bearer).status, allowed ? 200 : 403);
        line["format"] = "png";
        EXPECT_EQ(ask(line, "profile", "one", bearer).status, 200);
        EXPECT_EQ(ask(json::object(), "points", "two", bearer).status, 404);
        EXPECT_EQ(ask(json::object(), "points", "one").status, 401);
    }
}

// A block that is damaged behind those that have gone out: the connection ends before the last chunk.
TEST_F(PointsTest, ADamagedBlockCutsTheAnswerShortOrIsToldAtOnce) {
    start();
    const auto file = std::make_shared<FakeCloudFile>(3, 4, 20'000);
    add("fake", file);
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < file->nodes().size(); ++i)
        if (file->nodes()[i].node.isLeaf()) leaves.push_back(i);
    ASSERT_GT(leaves.size(), 30U);
    ASSERT_TRUE(ask({{"format", "csv"}}, "points", "fake").whole);
    const auto wanted = wantedLeaves(*file, {});
    file->damage(wanted.back().node);
    const HttpReply cut = ask({{"format", "csv"}}, "points", "fake");
    EXPECT_EQ(cut.status, 200);
    EXPECT_FALSE(cut.whole);
    EXPECT_FALSE(cut.body.empty());
    const client::Server asked(*client::parseServerUrl(server->url()));
    const auto truncated =
        asked.points("fake", {.format = PointsFormat::Csv}, [](auto) { return Expected<void>(); });
    ASSERT_FALSE(truncated);
    EXPECT_EQ(truncated.error().code, ErrorCode::Truncated) << truncated.error().message;
    file->damage(wanted.front().node);
    const HttpReply told = ask({{"format", "csv"}}, "points", "fake");
    EXPECT_EQ(told.status, 500);
    EXPECT_EQ(told.body.find("byte 4711"), std::string::npos) << "where the file lies is not for everybody";
}

TEST_F(PointsTest, WhoDoesNotReadIsCutOffAndKeepsNobodyWaiting) {
    options.limits.leastRate = {1 << 20, std::chrono::milliseconds(2000)};
    startWithSurvey();
    const auto file = std::make_shared<FakeCloudFile>(5, 4, 200'000);  // more than a socket holds
    add("fake", file);
    RawSocket deaf(port(), 4096);
    ASSERT_TRUE(deaf.send(requestFor("/api/v1/clouds/fake/points", {{"format", "csv"}})));
    ASSERT_FALSE(deaf.receive(100).empty());
    EXPECT_EQ(ask({{"format", "las"}}).status, 200) << "others are served meanwhile";
    EXPECT_TRUE(eventually([&] { return !metric("scancast_slow_readers_total").ends_with(" 0"); }));
    EXPECT_TRUE(eventually([&] { return held() == 0; })) << held();
}

TEST_F(PointsTest, WhoLeavesEndsTheWorkAndOneClientMayNotHaveItAll) {
    start();
    const auto file = std::make_shared<FakeCloudFile>(7, 3, 1'000);
    add("slow", file);
    file->setOpen(false);  // nothing of it can be read
    const std::shared_ptr<void> opened(nullptr,
                                       [&](const void*) { file->setOpen(true); });  // whatever fails here
    std::vector<std::unique_ptr<RawSocket>> waiting;
    const auto asks = [&] {
        waiting.push_back(std::make_unique<RawSocket>(port()));
        waiting.back()->send(requestFor("/api/v1/clouds/slow/points", {{"format", "csv"}}));
    };
    for (int i = 0; i < 3; ++i) asks();
    // What each of them needs is counted when it is admitted.
    ASSERT_TRUE(eventually([&] { return held() == 3.0 * (24 << 20); }));
    EXPECT_EQ(ask(json::object(), "points", "slow").status, 429);
    EXPECT_FALSE(ask(json::object(), "points", "slow").header("retry-after").empty());
    waiting.clear();
    file->setOpen(true);
    EXPECT_TRUE(eventually([&] { return ask({{"format", "csv"}}, "points", "slow").status == 200; }));
    EXPECT_TRUE(eventually([&] { return held() == 0; }));
}

// Not as the largest there may be: of that two would be more than all answers may have.
TEST_F(PointsTest, AProfilesPictureCountsAsHighAsItsCloudIs) {
    start();
    const auto file = std::make_shared<FakeCloudFile>(7, 3, 1'000);
    add("flat", file);
    file->setOpen(false);
    const std::shared_ptr<void> opened(nullptr, [&](const void*) { file->setOpen(true); });
    std::vector<std::unique_ptr<RawSocket>> waiting;
    for (int i = 0; i < 2; ++i) {
        waiting.push_back(std::make_unique<RawSocket>(port()));
        ASSERT_TRUE(waiting.back()->send(
            requestFor("/api/v1/clouds/flat/profile",
                       {{"line", {{0, 0}, {50, 0}}}, {"format", "png"}, {"picture", {{"width", 1000}}}})));
    }
    // A thousandth of its length is the least height of a profile.
    EXPECT_TRUE(eventually([&] { return held() == 2 * ((24 << 20) + 16.0 * 1000); })) << held();
}

TEST_F(PointsTest, TheClientLibraryHandsItOverPieceByPiece) {
    startWithSurvey();
    const client::Server asked(*client::parseServerUrl(server->url()));
    std::string bytes;
    const client::TakeBytes take = [&](std::span<const std::byte> more) -> Expected<void> {
        bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
        return {};
    };
    PointsRequest request{.format = PointsFormat::Las};
    request.region.z = {-3, 3};
    const auto answer = asked.points("survey", request, take);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_TRUE(bytes == exported(PointsFormat::Las, request.region));
    EXPECT_EQ(answer->bytes, bytes.size());
    EXPECT_TRUE(answer->points);
    ProfileRequest profile{.line = {{10, 10}, {150, 20}}, .width = 4};
    profile.picture.width = 320;
    bytes.clear();
    const auto facts = asked.profilePicture("survey", profile, take);
    ASSERT_TRUE(facts) << facts.error().message;
    EXPECT_TRUE(bytes.starts_with("\x89PNG"));
    EXPECT_GT(facts->points, 0U);
    EXPECT_DOUBLE_EQ(facts->length, std::hypot(140, 10));
    const auto refused = asked.points("nowhere", request, take);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::NotFound);
    const auto unwilling =
        asked.points("survey", request, [](auto) -> Expected<void> { return fail(ErrorCode::Io, "full"); });
    EXPECT_EQ(unwilling.error().message, "full");
}

}  // namespace
}  // namespace scancast::test
