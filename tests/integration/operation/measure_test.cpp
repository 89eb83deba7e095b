// Measurements over HTTP: arithmetic at once, volumes and shapes of the cloud's points, refusals that say what would do, and nothing that
// holds up anybody else. What the numbers are is tests/unit/measure's and tests/oracle/measure's.
#include <nlohmann/json.hpp>

#include "renderer/cloud/build/build_cloud.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {
namespace {

class MeasureTest : public ServerTest {
  protected:
    void SetUp() override {
        start();
        SyntheticSource source(20000, ball, {false, false, false, false}, 0.001);
        BuildOptions options;
        auto cloud = std::make_shared<Cloud>(**buildCloud(source, options));
        add("ball", cloud);
        cloud = std::make_shared<Cloud>(*cloud);
        cloud->crsWkt =
            R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["S",6378137,298.25]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])";
        cloud->crsEpsg = 4326;
        add("globe", cloud);
        cloud = std::make_shared<Cloud>(*cloud);
        cloud->crsWkt =
            R"(PROJCS["somewhere",GEOGCS["G",DATUM["D",SPHEROID["S",6378137,298.25]],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["US survey foot",0.304800609601219]])";
        cloud->crsEpsg.reset();
        add("feet", cloud);
    }
    void add(const char* id, const std::shared_ptr<const Cloud>& cloud) {
        server->catalog().setReady(server->catalog().add(id), cloud);
    }
    HttpReply ask(const nlohmann::json& body, const std::string& id = "ball") const {
        return post(port(), "/api/v1/clouds/" + id + "/measure", body.dump(), {sendsJson});
    }
    static nlohmann::json answer(const HttpReply& reply) {
        EXPECT_EQ(reply.status, 200) << reply.body;
        return parseJson(reply.body).value_or(nlohmann::json());
    }
};

const nlohmann::json line{{"measure", "distance"}, {"points", {{0, 0, 0}, {3, 4, 0}, {3, 4, 12}}}};

TEST_F(MeasureTest, VerticesTellLengthsAnglesAndAreas) {
    const auto length = answer(ask(line));
    EXPECT_EQ(length["length"], 17.0);
    EXPECT_EQ(length["vertical"], 12.0);
    EXPECT_TRUE(length["unit"].is_null()) << "nobody knows";
    EXPECT_EQ(answer(ask(line, "feet"))["unit"], "US survey foot");
    const auto angle = answer(ask({{"measure", "angle"}, {"points", line["points"]}}));
    EXPECT_EQ(angle["angles"][0]["vertex"], 1);
    EXPECT_NEAR(angle["angles"][0]["degrees"].get<double>(), 90, 1e-9);
    EXPECT_TRUE(angle["angles"][0]["plan"].is_null());
    EXPECT_EQ(
        answer(ask({{"measure", "area"}, {"points", {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}}}}))["area"],
        6.0);
}

TEST_F(MeasureTest, PointsTellVolumesAndShapes) {
    const nlohmann::json square{{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}};
    const auto volume = answer(ask({{"measure", "volume"}, {"points", square}, {"cell", 0.5}}));
    // The upper half of a ball over a square: between the ball's height at its corners and at its middle.
    EXPECT_GT(volume["above"].get<double>(), 100 * std::sqrt(50));
    EXPECT_LT(volume["above"].get<double>(), 100 * 10);
    EXPECT_EQ(volume["area"], 100.0);
    const auto sphere = answer(ask({{"measure", "sphere"}, {"points", {{0, 0, 10}}}, {"within", 8}}));
    EXPECT_NEAR(sphere["radius"].get<double>(), 10, 0.01);
    EXPECT_NEAR(sphere["diameter"].get<double>(), 20, 0.02);
    EXPECT_LT(sphere["rms"].get<double>(), 0.001);
    EXPECT_GT(sphere["used"].get<int>(), 1000);
}

TEST_F(MeasureTest, RefusalsSayWhy) {
    const auto degrees = ask(line, "globe");
    EXPECT_EQ(degrees.status, 422);
    EXPECT_NE(degrees.body.find("unit: degree"), std::string::npos) << degrees.body;
    EXPECT_EQ(ask({{"measure", "cylinder"}, {"points", {{90, 0, 0}}}, {"within", 1}}).status, 422)
        << "nothing there";
    const std::pair<nlohmann::json, const char*> wrong[] = {
        {{{"measure", "distance"}, {"points", {{0, 0, 0}}}}, "points"},
        {{{"measure", "weight"}, {"points", {{0, 0, 0}}}}, "measure"},
        {{{"measure", "volume"}, {"points", {{0, 0}, {1, 0}, {1, 1}}}, {"base", 1}, {"view", {{"fvo", 1}}}},
         "view.fvo"},
        {{{"measure", "volume"}, {"points", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, {"base", 1}}, "points"},
        {{{"measure", "volume"}, {"points", {{0, 0}, {1, 0}, {1, 1}}}, {"base", 1}, {"cell", 1e-6}}, "cell"},
        {{{"measure", "area"}, {"points", {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}}}, "points"},
    };
    for (const auto& [body, field] : wrong) {
        const HttpReply reply = ask(body);
        EXPECT_EQ(reply.status, 400) << body << reply.body;
        EXPECT_EQ(parseJson(reply.body).value()["errors"][0]["parameter"], field) << body;
    }
    EXPECT_EQ(ask(line, "none").status, 404);
    EXPECT_EQ(request(port(), "/api/v1/clouds/ball/measure").header("allow"), "POST");
}

TEST_F(MeasureTest, DamageIsAFaultOfTheServers) {
    add("cold", coldCloud());
    const HttpReply reply = ask({{"measure", "sphere"}, {"points", {{0, 0, 0}}}, {"within", 5}}, "cold");
    EXPECT_EQ(reply.status, 500);
    EXPECT_EQ(reply.body.find("never"), std::string::npos) << "why is for the log";
}

}  // namespace
}  // namespace scancast::test
