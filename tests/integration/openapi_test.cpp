// protocol/openapi.json is what programs are written from: every example in it is run against a server, and
// every answer is held against what it says.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "protocol/view/query.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;

TEST(JsonSchema, FindsWhatIsWrong) {
    const json document = {{"defs", {{"side", {{"type", "integer"}, {"minimum", 1}}}}}};
    const json schema = {
        {"type", "object"},
        {"properties", {{"width", {{"$ref", "#/defs/side"}}}, {"name", {{"pattern", "^a"}}}}},
        {"required", {"width"}},
        {"additionalProperties", false}};
    EXPECT_TRUE(schemaErrors(document, schema, {{"width", 3}, {"name", "ab"}}).empty());
    for (const json& wrong :
         {json(3), json{{"width", 0}}, json{{"width", 1.5}}, json{{"width", "3"}}, json::object(),
          json{{"width", 3}, {"height", 3}}, json{{"width", 3}, {"name", "b"}}})
        EXPECT_FALSE(schemaErrors(document, schema, wrong).empty()) << wrong;
    const json either = {
        {"anyOf", {{{"type", "null"}}, {{"type", "array"}, {"maxItems", 1}, {"items", {{"enum", {1, 2}}}}}}}};
    EXPECT_TRUE(schemaErrors(document, either, nullptr).empty());
    EXPECT_TRUE(schemaErrors(document, either, json::array({2})).empty());
    EXPECT_FALSE(schemaErrors(document, either, json::array({3})).empty());
    EXPECT_FALSE(schemaErrors(document, either, json::array({1, 2})).empty());
    EXPECT_FALSE(schemaErrors(document, {{"oneOf", json::array()}}, 3).empty()) << "an unknown keyword";
}

class OpenApiTest : public ServerTest {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(folder / "scans");
        std::ofstream(folder / "scans" / "church.las") << "a scan";
        options.dataRoot = folder;
        options.tokens.admins = {{"admin", admin}};
        options.tokens.guestKeys = {
            {"guests", "vN4xT0qLr8Yk-5WcZsHd_2GmPfJ7uBaE"}};  // that signed the example
        start();
        for (const char* id : {"town", "old-town"})
            server->catalog().setReady(server->catalog().add(id), inBerlin(withPhotos(*one)));
        server->admin().loadWith([](const auto&, const auto&) { return true; });
        document = parseJson(request(port(), "/openapi.json").body).value();
    }

    /// Maps need to know where in the world a cloud is.
    static std::shared_ptr<const Cloud> inBerlin(const std::shared_ptr<const Cloud>& cloud) {
        auto placed = std::make_shared<Cloud>(*cloud);
        placed->crsEpsg = 25833;
        return placed;
    }
    /// `path` with the examples of its placeholders, or, of a session, one that lives.
    std::string addressOf(std::string path, const json& operation) {
        const bool ofSession = path.find("/sessions/") != std::string::npos;
        for (const json& reference : operation.value("parameters", json::array())) {
            const json& parameter = resolved(document, reference);
            if (parameter["in"] != "path") continue;
            const std::string place = "{" + parameter["name"].get<std::string>() + "}";
            const json& example = parameter["example"];
            const auto at = path.find(place);
            if (at == std::string::npos) {
                ADD_FAILURE() << place << " is not in " << path;
                continue;
            }
            path.replace(at, place.size(),
                         ofSession             ? session
                         : example.is_string() ? example.get<std::string>()
                                               : example.dump());
        }
        EXPECT_EQ(path.find('{'), std::string::npos) << path;
        return path;
    }
    void expectDescribed(const std::string& what, const json& operation, const HttpReply& reply) {
        SCOPED_TRACE(what + " → " + std::to_string(reply.status) + " " + reply.body.substr(0, 300));
        EXPECT_LT(reply.status, 400);
        const std::string status = std::to_string(reply.status);
        ASSERT_TRUE(operation["responses"].contains(status)) << "an answer that is not described";
        const json& response = resolved(document, operation["responses"][status]);
        const json headers = response.value("headers", json::object());
        for (const auto& [name, header] : headers.items()) {
            if (name.starts_with("Scancast-")) continue;  // of depth, and of streams
            EXPECT_NE(reply.header(lowered(name)), "") << name;
        }
        if (!response.contains("content")) return;
        const std::string type = reply.header("content-type");
        ASSERT_TRUE(response["content"].contains(type)) << type;
        if (type.find("json") == std::string::npos) return;
        EXPECT_THAT(
            schemaErrors(document, response["content"][type]["schema"], parseJson(reply.body).value()),
            ::testing::IsEmpty());
    }
    void finishLoading() {
        for (const CatalogEntry& entry : server->catalog().list())
            if (entry.state == CloudState::Loading) server->catalog().setReady(entry.id, one);
    }
    static std::string lowered(std::string text) {
        for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
        return text;
    }
    HttpReply get(const std::string& method, const std::string& target) {
        return request(port(), target, {authorization}, method);
    }

    const std::string admin = "admin-0123456789abcdef";
    const std::string authorization = "Authorization: Bearer " + admin;
    const TemporaryFolder folder;
    json document;
    std::string session;
};

TEST_F(OpenApiTest, EveryExampleRunsAndEveryAnswerIsDescribed) {
    RawSocket driven(port());
    ASSERT_TRUE(driven.send(
        "GET /api/v1/clouds/town/stream.mjpg?width=32&height=16 HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    session = readReply(driven, false).header("scancast-session");
    ASSERT_FALSE(session.empty());
    int examples = 0;
    for (const auto& [path, operations] : document["paths"].items()) {
        for (const auto& [method, operation] : operations.items()) {
            const std::string target = addressOf(path, operation);
            if (method == "post") {
                const json& body = operation["requestBody"]["content"]["application/json"];
                ASSERT_FALSE(body["examples"].empty()) << path;
                for (const auto& [name, example] : body["examples"].items()) {
                    EXPECT_THAT(schemaErrors(document, body["schema"], example["value"]),
                                ::testing::IsEmpty())
                        << path;
                    // These are of the generated town, and asked of it in operation/measure_examples_test.cpp.
                    if (path.ends_with("/measure") &&
                        (example["value"]["measure"] == "volume" || example["value"]["measure"] == "circle"))
                        continue;
                    expectDescribed(path + " " + name, operation,
                                    post(port(), target, example["value"].dump(),
                                         {authorization, "Content-Type: application/json"}));
                    ++examples;
                }
                finishLoading();
                continue;
            }
            if (path == "/api/v1/stream") {
                EXPECT_EQ(RawWebSocket(port()).status(), 101);
                continue;
            }
            std::vector<std::string> queries{""};
            for (const json& reference : operation.value("parameters", json::array())) {
                const json& parameter = resolved(document, reference);
                if (parameter["in"] != "query" || !parameter.contains("example")) continue;
                const json& example = parameter["example"];
                EXPECT_THAT(schemaErrors(document, parameter["schema"], example), ::testing::IsEmpty());
                queries.push_back(
                    "?" + printQuery({{parameter["name"],
                                       example.is_string() ? example.get<std::string>() : example.dump()}}));
            }
            for (const std::string& query : queries) {
                const std::string verb = method == "delete" ? "DELETE" : "GET";
                expectDescribed(path + query, operation, get(verb, target + query));
                ++examples;
            }
        }
    }
    EXPECT_GT(examples, 90);
}

/// What is wrong is described, too.
TEST_F(OpenApiTest, ProblemsAreAsDescribed) {
    const std::tuple<std::string, std::string, std::string, int> wrong[] = {
        {"GET", "/api/v1/clouds/{id}", "/api/v1/clouds/nowhere", 404},
        {"GET", "/api/v1/clouds/{id}/photos/{n}", "/api/v1/clouds/town/photos/9", 404},
        {"GET", "/api/v1/clouds/{id}/snapshot.jpg", "/api/v1/clouds/town/snapshot.jpg?fvo=3", 400},
        {"GET", "/api/v1/clouds/{id}/snapshot.jpg", "/api/v1/clouds/town/snapshot.jpg?eye=1,1,1&target=1,1,1",
         422},
        {"GET", "/api/v1/clouds/{id}/snapshot.png",
         "/api/v1/clouds/town/snapshot.png?width=16384&height=16384", 413},
        {"GET", "/api/v1/clouds/{id}/stream.mjpg", "/api/v1/clouds/town/stream.mjpg?session=none", 404},
        {"DELETE", "/api/v1/clouds/{id}", "/api/v1/clouds/nowhere", 404},
        {"GET", "/api/v1/stream", "/api/v1/stream", 426},
    };
    for (const auto& [method, path, target, status] : wrong) {
        const HttpReply reply = get(method, target);
        EXPECT_EQ(reply.status, status) << target;
        const json& responses = document["paths"][path][method == "GET" ? "get" : "delete"]["responses"];
        ASSERT_TRUE(responses.contains(std::to_string(status))) << target;
        const json& content = resolved(document, responses[std::to_string(status)])["content"];
        EXPECT_THAT(schemaErrors(document, content["application/problem+json"]["schema"],
                                 parseJson(reply.body).value()),
                    ::testing::IsEmpty());
    }
}

}  // namespace
}  // namespace scancast::test
