#include "server/commands/config_file.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/commands/serve_options.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using ::testing::HasSubstr;

class ConfigFileTest : public ::testing::Test {
  protected:
    struct Parsed {
        ServeOptions options;
        CLI::App app;
        Expected<void> applied;
    };
    /// Command line first, then the file with this text, as `serve` does it.
    std::unique_ptr<Parsed> parsed(const std::string& text, std::vector<std::string> arguments = {}) {
        std::ofstream(file) << text;
        auto result = std::make_unique<Parsed>();
        addServeFlags(result->app, result->options);
        std::reverse(arguments.begin(), arguments.end());
        result->app.parse(arguments);
        result->applied = applyConfigFile(result->app, file);
        return result;
    }

    const test::TemporaryFolder folder;
    const std::string file = folder.file("scancast.json");
};

TEST_F(ConfigFileTest, KeysAreNamesOfFlags) {
    const auto p =
        parsed(R"({"files": ["a.las", "b.las"], "port": 9000, "memory-limit": "2G", "no-surfels": true,
                              "allowed-origin": ["https://a.example", "https://b.example"], "host": "localhost",
                              "allowed-host": ["a.example", "b.example"], "trusted-proxy": ["10.0.0.0/8", "::1"],
                              "admin-listen": "[::1]:9090", "max-connections": 900, "max-connections-per-address": 9})");
    ASSERT_TRUE(p->applied) << p->applied.error().message;
    EXPECT_EQ(p->options.files.size(), 2U);
    EXPECT_EQ(p->options.server.port, 9000);
    EXPECT_EQ(p->options.memoryLimit, "2G");
    EXPECT_TRUE(p->options.noSurfels);
    EXPECT_EQ(p->options.server.allowedOrigins.size(), 2U);
    EXPECT_EQ(p->options.server.allowedHosts.size(), 2U);
    EXPECT_EQ(p->options.trustedProxies.size(), 2U);
    EXPECT_EQ(p->options.adminListen, "[::1]:9090");
    EXPECT_EQ(p->options.maxConnections, 900U);
    EXPECT_EQ(p->options.server.limits.maxConnectionsPerAddress, 9U);
    EXPECT_EQ(p->options.server.host, "localhost");
    EXPECT_EQ(p->options.logLevel, "info");
}

TEST_F(ConfigFileTest, FlagBeforeEnvironmentBeforeFileBeforeDefault) {
    const std::string text = R"({"port": 9000, "files": "file.las", "max-sessions": 5})";
    EXPECT_EQ(parsed(text)->options.server.port, 9000);
    setenv("SCANCAST_PORT", "9001", 1);
    EXPECT_EQ(parsed(text)->options.server.port, 9001);
    EXPECT_EQ(parsed(text, {"--port", "9002"})->options.server.port, 9002);
    unsetenv("SCANCAST_PORT");
    EXPECT_EQ(parsed("{}")->options.server.port, 8080);
    EXPECT_EQ(parsed(text, {"line.las"})->options.files.front(), "line.las");
    EXPECT_EQ(parsed(text)->options.server.limits.maxSessions, 5U);
}

TEST_F(ConfigFileTest, WhatIsWrongIsNamed) {
    const std::pair<const char*, const char*> wrong[] = {
        {R"({"prot": 9000})", "did you mean port?"},
        {R"({"port": 70000})", "port: "},
        {R"({"port": "http"})", "port: "},
        {R"({"port": [1, 2]})", "port: takes one value"},
        {R"({"port": null})", "port: "},
        {R"({"port": true})", "port: "},
        {R"({"no-surfels": 1})", "no-surfels: expected true or false"},
        {R"({"backend": "vulkan"})", "backend: "},
        {R"({"config": "more.json"})", "unknown"},
        {R"({"port": 1, "port": 2})", "port"},
        {R"([])", "JSON object"},
        {R"({)", "scancast.json"},
    };
    for (const auto& [text, words] : wrong) {
        const auto p = parsed(text);
        ASSERT_FALSE(p->applied) << text;
        EXPECT_THAT(p->applied.error().message, HasSubstr(words)) << text;
        EXPECT_THAT(p->applied.error().message, HasSubstr("--config ")) << text;
    }
    CLI::App app;
    ServeOptions options;
    addServeFlags(app, options);
    const auto nowhere = applyConfigFile(app, "/nowhere/at/all.json");
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().message, "--config /nowhere/at/all.json: there is no such file");
    EXPECT_THAT(applyConfigFile(app, "/dev/zero").error().message, HasSubstr("is a device, not a file"));
}

TEST_F(ConfigFileTest, TheDocumentedExampleIsLegal) {
    std::ifstream page(SCANCAST_SOURCE_DIR "/docs/configuration.md");
    const std::string text{std::istreambuf_iterator<char>(page), {}};
    const auto start = text.find("```json\n") + 8;
    const auto p = parsed(text.substr(start, text.find("```", start) - start));
    ASSERT_TRUE(p->applied) << p->applied.error().message;
    EXPECT_EQ(p->options.server.port, 8443);
    EXPECT_EQ(p->options.server.dataRoot, "/srv/scans");
}

/// The test: what is printed, read again, prints the same.
TEST_F(ConfigFileTest, WhatHoldsIsAConfigurationFileItself) {
    const auto p =
        parsed(R"({"files": "town.las", "port": 9000, "insecure": true, "gpu-memory-limit": "1G"})",
               {"--max-sessions", "7", "--auth-token-file", "token"});
    ASSERT_TRUE(p->applied) << p->applied.error().message;
    const auto config = effectiveConfig(p->app);
    EXPECT_EQ(config["port"], 9000);
    EXPECT_EQ(config["max-sessions"], 7);
    EXPECT_EQ(config["insecure"], true);
    EXPECT_EQ(config["no-surfels"], false);
    EXPECT_EQ(config["host"], "127.0.0.1");
    EXPECT_EQ(config["files"], nlohmann::json::array({"town.las"}));
    EXPECT_EQ(config["auth-token-file"], "token");
    EXPECT_FALSE(config.contains("config"));
    EXPECT_FALSE(config.contains("cache-dir"));
    const auto again = parsed(config.dump());
    ASSERT_TRUE(again->applied) << again->applied.error().message;
    EXPECT_EQ(effectiveConfig(again->app), config);
}

TEST_F(ConfigFileTest, WhatWasGivenGoesBeforeTheFileOnAnotherAppToo) {
    std::vector<std::string> arguments{"--max-sessions",      "7",      "--no-surfels", "--allowed-host",
                                       "a.example,b.example", "one.las"};
    std::reverse(arguments.begin(), arguments.end());
    ServeOptions first, second;
    CLI::App app, again;
    addServeFlags(app, first);
    app.parse(arguments);
    const GivenFlags given = givenFlags(app);
    addServeFlags(again, second);
    ASSERT_TRUE(applyGivenFlags(again, given));
    std::ofstream(file) << R"({"max-sessions": 9, "port": 9001, "no-surfels": false, "files": ["two.las"]})";
    ASSERT_TRUE(applyConfigFile(again, file));
    EXPECT_EQ(second.server.limits.maxSessions, 7U);
    EXPECT_TRUE(second.noSurfels);
    EXPECT_EQ(second.server.allowedHosts, first.server.allowedHosts);
    EXPECT_EQ(second.files, std::vector<std::filesystem::path>{"one.las"});
    EXPECT_EQ(second.server.port, 9001);
    ASSERT_TRUE(applyConfigFile(app, file));
    EXPECT_EQ(effectiveConfig(again), effectiveConfig(app));
}

}  // namespace
}  // namespace scancast
