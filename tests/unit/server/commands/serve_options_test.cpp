#include "server/commands/serve_options.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace scancast {
namespace {

ServeOptions parsed(std::vector<std::string> arguments) {
    ServeOptions options;
    CLI::App app;
    addServeFlags(app, options);
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    return options;
}

TEST(ServeOptions, Defaults) {
    const ServeOptions options = parsed({"town.las"});
    EXPECT_EQ(options.server.host, "127.0.0.1");
    EXPECT_EQ(options.server.port, 8080);
    EXPECT_TRUE(check(options));
}

TEST(ServeOptions, FlagBeforeEnvironmentBeforeDefault) {
    setenv("SCANCAST_PORT", "9001", 1);
    EXPECT_EQ(parsed({"a.las"}).server.port, 9001);
    EXPECT_EQ(parsed({"a.las", "--port", "9002"}).server.port, 9002);
    unsetenv("SCANCAST_PORT");
    EXPECT_EQ(parsed({"a.las"}).server.port, 8080);
}

TEST(ServeOptions, LiveSourcesAreNamed) {
    const ServeOptions options = parsed({"--live", "depth=-", "--live", "other=/run/other.fifo"});
    EXPECT_TRUE(check(options)) << "nothing else is needed";
    const auto inputs = liveInputs(options);
    ASSERT_TRUE(inputs);
    ASSERT_EQ(inputs->size(), 2U);
    EXPECT_EQ(inputs->at(0).name, "depth");
    EXPECT_EQ(inputs->at(0).path, "-");
    EXPECT_EQ(inputs->at(1).path, "/run/other.fifo");
    for (const char* wrong : {"depth", "=-", "depth=", ""}) {
        const auto refused = check(parsed({std::string("--live=") + wrong, "town.las"}));
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::HasSubstr("NAME=PATH"));
    }
    EXPECT_FALSE(check(parsed({"--live", "a=-", "--live", "b=-"}))) << "one input, two readers";
}

TEST(ServeOptions, CloudsAndWhatIsKeptOfThemAreLimited) {
    EXPECT_EQ(parsed({"a.las"}).server.maxClouds, 256U);
    EXPECT_TRUE(check(parsed({"a.las", "b.las", "--max-clouds", "2"})));
    const auto many = check(parsed({"a.las", "b.las", "--live", "c=-", "--max-clouds", "2"}));
    ASSERT_FALSE(many);
    EXPECT_THAT(many.error().message, testing::HasSubstr("3 clouds are named, and 2 may be served"));
    EXPECT_EQ(cacheSize(parsed({"a.las"})).value(), 0U);
    EXPECT_EQ(cacheSize(parsed({"a.las", "--cache-dir", "/tmp", "--cache-size", "20G"})).value(),
              std::uint64_t(20) << 30);
    for (const auto& wrong : {std::vector<std::string>{"a.las", "--cache-size", "1G"},
                              {"a.las", "--cache-dir", "/tmp", "--cache-size", "much"},
                              {"a.las", "--cache-dir", "/tmp", "--cache-size", "0"}}) {
        const auto refused = check(parsed(wrong));
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().field, "cache-size");
    }
}

TEST(ServeOptions, ImportersAreLimitedAndShutInAsFlagsSay) {
    const ServeOptions usual = parsed({"a.laz"});
    const auto import = importOptions(usual.importer);
    ASSERT_TRUE(import);
    EXPECT_EQ(import->importerMemoryLimit, std::uint64_t(16) << 30);
    EXPECT_EQ(import->importerProcessorSeconds, 7200u);
    EXPECT_EQ(import->importerSilenceSeconds, 60);
    EXPECT_EQ(import->importerSandbox, ImporterSandbox::Auto);
    EXPECT_EQ(usual.importers, 2);
    const ServeOptions other =
        parsed({"a.laz", "--importer-memory", "2G", "--importer-time", "90", "--importer-silence", "5",
                "--importer-sandbox", "require", "--importers", "7"});
    const auto said = importOptions(other.importer);
    ASSERT_TRUE(said);
    EXPECT_EQ(said->importerMemoryLimit, std::uint64_t(2) << 30);
    EXPECT_EQ(said->importerProcessorSeconds, 90u);
    EXPECT_EQ(said->importerSilenceSeconds, 5);
    EXPECT_EQ(said->importerSandbox, ImporterSandbox::Require);
    EXPECT_EQ(other.importers, 7);
    setenv("SCANCAST_IMPORTER_SANDBOX", "off", 1);
    EXPECT_EQ(importOptions(parsed({"a.laz"}).importer)->importerSandbox, ImporterSandbox::Off);
    unsetenv("SCANCAST_IMPORTER_SANDBOX");
    for (const char* wrong : {"plenty", "1M"}) {
        const auto refused = check(parsed({"a.laz", "--importer-memory", wrong}));
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::HasSubstr("--importer-memory"));
    }
    for (const auto& [flag, wrong] :
         {std::pair("--importer-sandbox", "perhaps"), std::pair("--importers", "0"),
          std::pair("--importer-silence", "0"), std::pair("--importer-time", "0")})
        EXPECT_THROW(parsed({"a.laz", flag, wrong}), CLI::ValidationError) << flag;
}

TEST(ServeOptions, ACrsIsANumberOrAText) {
    EXPECT_EQ(importOptions(parsed({"a.las"}).importer)->assumeCrs, std::nullopt);
    EXPECT_EQ(importOptions(parsed({"a.las", "--assume-crs", "EPSG:25832"}).importer)->assumeCrs,
              (AssumedCrs{"", 25832}));
    const auto refused = check(parsed({"a.las", "--assume-crs", "UTM 32"}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("--assume-crs"));
}

TEST(ServeOptions, MemoryIsMeasuredAsPeopleWriteIt) {
    constexpr std::uint64_t MiB = 1 << 20;
    const auto shares = [](std::vector<std::string> flags) {
        flags.insert(flags.begin(), "a.scan");
        return memoryShares(parsed(std::move(flags))).value();
    };
    EXPECT_EQ(shares({"--memory-limit", "512M"}).clouds, 320 * MiB);
    EXPECT_EQ(shares({"--memory-limit", "512M"}).transient, 192 * MiB);
    EXPECT_EQ(shares({"--memory-limit", "64G"}).transient, 2048 * MiB);
    EXPECT_EQ(shares({"--memory-limit", "2G", "--transient-limit", "100M"}).clouds, 1948 * MiB);
    EXPECT_GE(shares({}).clouds + shares({}).transient, 64 * MiB) << "half of the machine's";
    for (const char* wrong : {"7M", "500M", "much"})
        EXPECT_EQ(memoryShares(parsed({"a.scan", "--memory-limit", "512M", "--transient-limit", wrong}))
                      .error()
                      .field,
                  "transient-limit");
    for (const char* wrong : {"plenty", "1M", "-2G"}) {
        const auto refused = check(parsed({"a.scan", std::string("--memory-limit=") + wrong}));
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::HasSubstr("memory-limit"));
    }
}

TEST(ServeOptions, SoIsTheGpusMemory) {
    EXPECT_TRUE(check(parsed({"a.scan"})));
    EXPECT_TRUE(check(parsed({"a.scan", "--gpu-memory-limit", "512M"})));
    for (const char* wrong : {"plenty", "1M", "-2G"}) {
        const auto refused = check(parsed({"a.scan", std::string("--gpu-memory-limit=") + wrong}));
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, testing::HasSubstr("--gpu-memory-limit"));
    }
}

TEST(ServeOptions, TheCacheFolderMustBeThere) {
    EXPECT_TRUE(check(parsed({"a.las", "--cache-dir", testing::TempDir()})));
    EXPECT_FALSE(check(parsed({"a.las", "--cache-dir", "/nowhere/at/all"})));
}

TEST(ServeOptions, FilesAndOriginsMayBeMany) {
    const auto options =
        parsed({"--allowed-origin", "https://a.example", "x.las", "y.ply", "--allowed-origin", "http://b:1"});
    EXPECT_EQ(options.files.size(), 2U);
    EXPECT_EQ(options.server.allowedOrigins.size(), 2U);
    EXPECT_TRUE(check(options));
}

TEST(ServeOptions, BadValuesAreRefusedByTheParser) {
    for (const char* port : {"-1", "65536", "http"}) {
        EXPECT_THROW(parsed({"a.las", "--port", port}), CLI::ParseError) << port;
    }
    EXPECT_THROW(parsed({"a.las", "--backend", "vulkan"}), CLI::ParseError);
    EXPECT_THROW(parsed({"a.las", "--max-pixels", "0"}), CLI::ParseError);
}

TEST(ServeOptions, OtherAddressesNeedATokenOrInsecure) {
    for (const char* host : {"0.0.0.0", "192.168.1.7", "scans.example.org", "::", "127.example.org"}) {
        const auto refused = check(parsed({"a.las", "--host", host}));
        ASSERT_FALSE(refused) << host;
        EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--insecure"));
        EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--auth-token-file"));
        EXPECT_TRUE(check(parsed({"a.las", "--host", host, "--auth-token-file", "t"}))) << host;
        EXPECT_FALSE(check(parsed({"a.las", "--host", host, "--admin-token-file", "t"}))) << host;
        EXPECT_TRUE(check(parsed({"a.las", "--host", host, "--insecure"}))) << host;
    }
    for (const char* host : {"localhost", "127.0.0.2", "::1"})
        EXPECT_TRUE(check(parsed({"a.las", "--host", host}))) << host;
}

TEST(ServeOptions, TokensComeFromFilesAndDiffer) {
    const test::TemporaryFolder folder;
    const auto write = [&](const char* name, const char* text) {
        const auto path = folder / name;
        std::ofstream(path) << text;
        std::filesystem::permissions(path, std::filesystem::perms::owner_read);
        return path.string();
    };
    const std::string user = write("scancast_user_token", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo\n");
    const std::string admin =
        write("scancast_admin_token",
              "# two\nalice Zk3_tP8wQd-1HvNx5yMjR2bFsLg7cUaE\nbob 8f3a1c9e5b7d204f6a8e0c2b4d9f1735\n");
    const auto tokens =
        accessTokens(parsed({"a.las", "--auth-token-file", user, "--admin-token-file", admin}));
    ASSERT_TRUE(tokens) << tokens.error().message;
    EXPECT_EQ(tokens->users, (std::vector<NamedToken>{{"user", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"}}));
    EXPECT_EQ(tokens->admins, (std::vector<NamedToken>{{"alice", "Zk3_tP8wQd-1HvNx5yMjR2bFsLg7cUaE"},
                                                       {"bob", "8f3a1c9e5b7d204f6a8e0c2b4d9f1735"}}));
    EXPECT_TRUE(accessTokens(parsed({"a.las"}))->users.empty());
    const auto same = accessTokens(parsed({"a.las", "--auth-token-file", user, "--admin-token-file", user}));
    ASSERT_FALSE(same);
    EXPECT_THAT(same.error().message, ::testing::Not(::testing::HasSubstr("q7Rf")));
    for (const char* other : {"--auth-token-file", "--admin-token-file", "--guest-key-file"}) {
        const auto twice = accessTokens(parsed({"a.las", other, user, "--session-key-file", user}));
        ASSERT_FALSE(twice) << other;
        EXPECT_EQ(twice.error().field, "session-key-file");
        EXPECT_THAT(twice.error().message, ::testing::AllOf(::testing::HasSubstr(other),
                                                            ::testing::Not(::testing::HasSubstr("q7Rf"))));
    }
    EXPECT_TRUE(accessTokens(parsed({"a.las", "--auth-token-file", user, "--session-key-file", admin})));
    const auto missing = accessTokens(parsed({"a.las", "--auth-token-file", "/no/such/file"}));
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, ::testing::StartsWith("--auth-token-file: /no/such/file"));
    const std::string weak = write("weak_token", "letmein-0123456789\n");
    EXPECT_THAT(
        accessTokens(parsed({"a.las", "--auth-token-file", weak})).error().message,
        ::testing::AllOf(::testing::HasSubstr(weak + ":1: "), ::testing::HasSubstr("scancast token NAME"),
                         ::testing::Not(::testing::HasSubstr("letmein"))));
    std::filesystem::remove(user);
    std::filesystem::remove(admin);
}

TEST(ServeOptions, NothingToServeNamesTheWayOut) {
    const auto refused = check(parsed({}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr("scancast generate town"));
}

TEST(ServeOptions, NamesAndProxiesAreLists) {
    const auto given = parsed({"a.las", "--allowed-host", "a.example", "--allowed-host",
                               "b.example,c.example", "--trusted-proxy", "10.0.0.0/8,fd00::1"});
    EXPECT_THAT(given.server.allowedHosts, ::testing::ElementsAre("a.example", "b.example", "c.example"));
    EXPECT_THAT(given.trustedProxies, ::testing::ElementsAre("10.0.0.0/8", "fd00::1"));
    EXPECT_TRUE(check(given));
    setenv("SCANCAST_TRUSTED_PROXY", "10.0.0.0/8,192.168.0.1", 1);
    EXPECT_EQ(parsed({"a.las"}).trustedProxies.size(), 2U);
    unsetenv("SCANCAST_TRUSTED_PROXY");
    for (const auto& [flag, value] :
         {std::pair("--allowed-host", "https://a.example"), std::pair("--trusted-proxy", "10.0.0.1/8")}) {
        const auto refused = check(parsed({"a.las", flag, value}));
        ASSERT_FALSE(refused) << flag;
        EXPECT_THAT(refused.error().message, ::testing::StartsWith(std::string(flag) + ": "));
    }
}

TEST(ServeOptions, ConnectionsAreAtLeastSessions) {
    EXPECT_EQ(maxConnections(parsed({"a.las", "--max-sessions", "10", "--max-connections", "20"})).value(),
              20U);
    const auto refused = check(parsed({"a.las", "--max-connections", "20"}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--max-sessions 64"));
}

TEST(ServeOptions, ProbesForOtherMachinesNeedATokenOrInsecure) {
    EXPECT_FALSE(adminListen(parsed({"a.las"})).value());
    EXPECT_EQ(adminListen(parsed({"a.las", "--admin-listen", "[::1]:9090"})).value()->port, 9090);
    EXPECT_TRUE(check(parsed({"a.las", "--admin-listen", "127.0.0.1:9090"})));
    EXPECT_FALSE(check(parsed({"a.las", "--admin-listen", "9090"})));
    const auto refused = check(parsed({"a.las", "--admin-listen", "0.0.0.0:9090"}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr("--auth-token-file"));
    EXPECT_TRUE(check(parsed({"a.las", "--admin-listen", "0.0.0.0:9090", "--insecure"})));
    EXPECT_TRUE(check(parsed({"a.las", "--admin-listen", "0.0.0.0:9090", "--auth-token-file", "t"})));
}

TEST(ServeOptions, AnOriginMustBeOne) {
    EXPECT_FALSE(check(parsed({"a.las", "--allowed-origin", "viewer.example"})));
}

}  // namespace
}  // namespace scancast
