// Columns over a real socket: what a cloud says of them, words that name them, and points, profiles and volumes of what a filter leaves. What
// pictures show is tests/oracle/device/columns_test.cpp's.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/column_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

class ColumnsOverHttp : public ServerTest {
  protected:
    static constexpr std::uint64_t count = sized(20'000, 6'000);

    void SetUp() override {
        start();
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<ColumnSource>(count, ground));
        IngestOptions options;
        options.shape.leafPoints = 1000;
        options.shape.surfels = false;
        options.output = folder_ / "flight.scan";
        ASSERT_TRUE(ingest(std::move(sources), options, {}, {}));
        server->catalog().setReady(server->catalog().add("flight"),
                                   openCloud(folder_ / "flight.scan", cache_).value());
    }
    HttpReply get(const std::string& what) const { return request(port(), "/api/v1/clouds/flight" + what); }
    HttpReply ask(const std::string& what, const nlohmann::json& body) const {
        return post(port(), "/api/v1/clouds/flight/" + what, body.dump(), {sendsJson});
    }

    const TemporaryFolder folder_;
    std::shared_ptr<BlockCache> cache_ =
        BlockCache::create({.memoryLimit = 64'000'000, .threads = 1, .onDamaged = {}});
};

TEST_F(ColumnsOverHttp, AreListedWithWhatASliderNeeds) {
    const auto cloud = nlohmann::json::parse(get("").body);
    const auto& columns = cloud["columns"];
    ASSERT_EQ(columns.size(), 5u) << columns;
    EXPECT_EQ(columns[0]["name"], "amount");
    EXPECT_EQ(columns[0]["description"], "so much");
    EXPECT_EQ(columns[4]["name"], "intensity") << "asked for in the same way";
    for (const auto& column : columns) {
        EXPECT_TRUE(column["drawn"].get<bool>());
        EXPECT_LE(column["usual"][0].get<double>(), column["usual"][1].get<double>());
        const auto& histogram = column["histogram"];
        EXPECT_LT(histogram["low"].get<double>(), histogram["high"].get<double>());
        std::uint64_t all = 0;
        for (const auto& part : histogram["counts"]) all += part.get<std::uint64_t>();
        EXPECT_LE(all, count);
        EXPECT_GE(all, count * 9 / 10);
    }
    EXPECT_EQ(columns[2]["histogram"]["counts"].size(), 5u);
}

TEST_F(ColumnsOverHttp, WordsArePartOfAPicturesIdentity) {
    const std::string size = "/snapshot.png?width=40&height=30&samples=1";
    const auto tag = [&](const std::string& words) {
        const HttpReply reply = get(size + words);
        EXPECT_EQ(reply.status, 200) << words << ": " << reply.body;
        return reply.header("etag");
    };
    std::vector<std::string> tags{tag(""),
                                  tag("&filter=amount:0.."),
                                  tag("&filter=amount:1.."),
                                  tag("&filter=amount:0..;returns:..3"),
                                  tag("&color=column:amount"),
                                  tag("&color=column:shot%3B%20time"),
                                  tag("&color=column:amount&range=0,5"),
                                  tag("&filter=shot%253B%20time:5..6")};
    std::ranges::sort(tags);
    EXPECT_EQ(std::ranges::adjacent_find(tags), tags.end());
    EXPECT_EQ(tag("&filter=amount:0.."), tag("&filter=amount:0.0.."));
}

TEST_F(ColumnsOverHttp, WhatThereIsNotIsRefusedWithWhatThereIs) {
    for (const char* words : {"filter=amonut:0..", "color=column:amonut"}) {
        const HttpReply reply = get(std::string("/snapshot.png?") + words);
        EXPECT_EQ(reply.status, 422) << reply.body;
        for (const char* name : {"amonut", "amount", "returns", "shot; time"})
            EXPECT_NE(reply.body.find(name), std::string::npos) << reply.body;
    }
    EXPECT_EQ(get("/snapshot.png?filter=amount:5..1").status, 400);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/snapshot.png?filter=amount:1..").status, 422)
        << "a cloud in memory keeps none";
    const HttpReply points = ask("points", {{"region", {{"filter", {{{"column", "no"}, {"low", 1}}}}}}});
    EXPECT_EQ(points.status, 422);
    EXPECT_NE(points.body.find("region.filter"), std::string::npos) << points.body;
}

TEST_F(ColumnsOverHttp, PointsAndProfilesAreWhatTheFilterLeaves) {
    const nlohmann::json filter{{{"column", "returns"}, {"low", 2}, {"high", 3}},
                                {{"column", "amount"}, {"low", 0}}};
    const auto passes = [](std::uint64_t i) {
        return returnsOf(i) >= 2 && returnsOf(i) <= 3 && amountOf(i) >= 0;
    };
    std::vector<std::uint64_t> expected;
    for (std::uint64_t i = 0; i < count; ++i)
        if (passes(i)) expected.push_back(i);
    const auto numbersIn = [](const std::string& csv) {
        std::vector<std::uint64_t> numbers;
        for (std::size_t line = csv.find('\n') + 1; line < csv.size(); line = csv.find('\n', line) + 1) {
            const std::size_t end = csv.find('\n', line);
            const std::size_t comma = csv.rfind(',', end);
            numbers.push_back(std::stoull(csv.substr(comma + 1, end - comma - 1)));
        }
        std::ranges::sort(numbers);
        return numbers;
    };
    const HttpReply csv = ask("points", {{"format", "csv"}, {"region", {{"filter", filter}}}});
    ASSERT_EQ(csv.status, 200) << csv.body;
    EXPECT_EQ(numbersIn(csv.body), expected);
    const HttpReply las = ask("points", {{"format", "las"}, {"region", {{"filter", filter}}}});
    EXPECT_EQ(las.header("scancast-points"), std::to_string(expected.size()));

    const nlohmann::json line{
        {"line", {{0, 100}, {200, 100}}}, {"width", 20}, {"region", {{"filter", filter}}}};
    const HttpReply along = ask("profile", line);
    ASSERT_EQ(along.status, 200) << along.body;
    std::erase_if(expected,
                  [&](std::uint64_t i) { return std::abs(ground(i, count).position.y - 100) > 10; });
    const auto profiled = numbersIn(along.body);
    EXPECT_NEAR(double(profiled.size()), double(expected.size()), 2) << "but for points rounded at its edge";
    for (const std::uint64_t number : profiled) EXPECT_TRUE(passes(number));

    nlohmann::json picture = line;
    picture["format"] = "png";
    picture["picture"] = {{"color", "column:amount"}, {"colormap", "turbo"}, {"width", 200}};
    const HttpReply png = ask("profile", picture);
    ASSERT_EQ(png.status, 200) << png.body;
    EXPECT_EQ(nlohmann::json::parse(png.header("scancast-profile"))["points"].get<std::size_t>(),
              profiled.size());
    picture["picture"]["color"] = "column:no";
    const HttpReply refused = ask("profile", picture);
    EXPECT_EQ(refused.status, 422);
    EXPECT_NE(refused.body.find("picture.color"), std::string::npos) << refused.body;
}

TEST_F(ColumnsOverHttp, VolumesCountWhatTheFilterLeaves) {
    const auto volume = [&](const nlohmann::json& filter) {
        const HttpReply reply =
            ask("measure", {{"measure", "volume"},
                            {"points", {{10, 10, 0}, {190, 10, 0}, {190, 190, 0}, {10, 190, 0}}},
                            {"view", {{"filter", filter}}}});
        EXPECT_EQ(reply.status, 200) << reply.body;
        return nlohmann::json::parse(reply.body);
    };
    const auto all = volume(nullptr), some = volume({{{"column", "returns"}, {"high", 1}}});
    EXPECT_NE(all, some);
}

}  // namespace
}  // namespace scancast::test
