// The measurements that PROTOCOL.md, docs/measure.md and openapi.json show, asked of the town that README.md generates: what they find is
// what the generator made, known without a point of the scan.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "renderer/cloud/build/build_cloud.hpp"
#include "simulator/scene.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/json_schema.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;

std::string textOf(const std::string& path) {
    std::ifstream file(SCANCAST_SOURCE_DIR "/" + path);
    EXPECT_TRUE(file) << path << " is not there";
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The bodies of curl: what stands behind -d between single quotes, and measures.
std::vector<json> bodiesIn(const std::string& text) {
    std::vector<json> bodies;
    const std::string start = R"('{"measure":)";
    for (auto at = text.find(start); at != std::string::npos; at = text.find(start, at + 1))
        bodies.push_back(json::parse(text.substr(at + 1, text.find('\'', at + 1) - at - 1)));
    return bodies;
}

class MeasureExamples : public ServerTest {
  protected:
    void SetUp() override {
        start();
        // Few points, so that it is built soon: examples have to find something in any town.
        auto source = simulate({.scene = "town", .points = 300'000}).value();
        server->catalog().setReady(server->catalog().add("town"), *buildCloud(*source, {.title = "town"}));
        document = parseJson(request(port(), "/openapi.json").body).value();
    }
    /// The answer is described, and true to what the town is.
    void expectFound(const json& body) {
        SCOPED_TRACE(body.dump());
        const HttpReply reply =
            post(port(), "/api/v1/clouds/town/measure", body.dump(), {"Content-Type: application/json"});
        ASSERT_EQ(reply.status, 200) << reply.body;
        const json answer = parseJson(reply.body).value();
        EXPECT_THAT(schemaErrors(document, document["components"]["schemas"]["Measured"], answer),
                    ::testing::IsEmpty());
        const std::string kind = body["measure"];
        if (kind == "volume") {
            // A house beside the square; rays from above through the town itself say 845.0 over 34.12.
            EXPECT_EQ(answer["holes"], 0);
            if (body["base"] == 34.12) {
                EXPECT_NEAR(answer["above"].get<double>(), 845, 0.02 * 845);
            } else {
                EXPECT_GT(answer["above"].get<double>(), 100);
            }
        } else if (kind == "circle") {
            // The fountain's basin: 6.4 m across, around the town's middle.
            EXPECT_NEAR(answer["diameter"].get<double>(), 6.4, 0.02);
            EXPECT_NEAR(answer["center"][0].get<double>(), 389500, 0.02);
            EXPECT_NEAR(answer["center"][1].get<double>(), 5819800, 0.02);
        } else if (kind == "sphere") {
            // The ball on the fountain.
            EXPECT_NEAR(answer["diameter"].get<double>(), 0.54, 0.01);
        } else {
            EXPECT_TRUE(kind == "distance" || kind == "angle" || kind == "area") << "say here what is true";
        }
    }
    json document;
};

TEST_F(MeasureExamples, FindWhatTheGeneratorMade) {
    std::size_t volumes = 0, circles = 0;
    const auto expectAll = [&](const std::vector<json>& bodies, const char* where) {
        EXPECT_GE(bodies.size(), 3U) << where;
        for (const json& body : bodies) {
            volumes += body["measure"] == "volume";
            circles += body["measure"] == "circle";
            expectFound(body);
        }
    };
    for (const char* page : {"protocol/PROTOCOL.md", "docs/measure.md"})
        expectAll(bodiesIn(textOf(page)), page);
    std::vector<json> described;
    const json& path = document["paths"]["/api/v1/clouds/{id}/measure"]["post"];
    for (const json& example : path["requestBody"]["content"]["application/json"]["examples"])
        described.push_back(example["value"]);
    expectAll(described, "openapi.json");
    EXPECT_GE(volumes, 4U);
    EXPECT_GE(circles, 3U);
}

}  // namespace
}  // namespace scancast::test
