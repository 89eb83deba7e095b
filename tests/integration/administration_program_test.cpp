// Administration and configuration as people meet them: a server that starts empty, gets a scan, and gives it
// back.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class AdministrationProgramTest : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        std::ofstream(folder / "admin") << "# who administers\nalice " << token << "\n";
        fs::permissions(folder / "admin", fs::perms::owner_read | fs::perms::owner_write);
        fs::create_directories(folder / "scans");
        generate("scans/ball.las");
        generate("first.las");
    }
    int statusOf(const std::string& target) const { return request(port, target).status; }
    static bool comesTrue(const std::function<bool()>& condition) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!condition()) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return true;
    }
    bool becomes(const std::string& target, int status) const {
        return comesTrue([&] { return statusOf(target) == status; });
    }
    /// Pictures there are sooner: coarse ones, of what has been read.
    bool isLoaded(const std::string& id) const {
        return comesTrue([&] {
            const json cloud = json::parse(request(port, "/api/v1/clouds/" + id).body, nullptr, false);
            return cloud.is_object() && cloud.value("state", "") == "ready";
        });
    }
    const std::string token = "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo";
    const std::string bearer = "Authorization: Bearer " + token;
};

TEST_F(AdministrationProgramTest, AScanComesAndGoesWhileTheServerRuns) {
    const auto server =
        serve({file("first.las"), "--data-root", file("scans"), "--admin-token-file", file("admin")});
    const HttpReply added = post(port, "/api/v1/clouds", R"({"file": "ball.las", "title": "A ball"})",
                                 {bearer, "Content-Type: application/json"});
    ASSERT_EQ(added.status, 202) << added.body;
    ASSERT_TRUE(becomes("/api/v1/clouds/ball/snapshot.jpg?width=32&height=16", 200)) << server->err();
    EXPECT_THAT(request(port, "/api/v1/clouds/ball").body, HasSubstr("A ball"));
    EXPECT_TRUE(becomes("/readyz", 200));
    EXPECT_TRUE(isLoaded("ball"));
    EXPECT_EQ(request(port, "/api/v1/clouds/ball", {bearer}, "DELETE").status, 204);
    EXPECT_EQ(statusOf("/api/v1/clouds/ball"), 404);
    EXPECT_TRUE(fs::exists(folder / "scans" / "ball.las"));
    EXPECT_EQ(statusOf("/api/v1/clouds/first"), 200);
}

TEST_F(AdministrationProgramTest, WhatIsNoFileOrLiesOutsideIsRefusedAtOnce) {
    ASSERT_EQ(mkfifo(file("scans/pipe.las").c_str(), 0600), 0);
    fs::create_symlink("../first.las", folder / "scans" / "out.las");
    fs::create_symlink("loop.las", folder / "scans" / "loop.las");
    fs::create_symlink("/dev/zero", folder / "scans" / "zero.las");
    fs::create_directories(folder / "scans" / "folder.las");
    const auto server =
        serve({file("first.las"), "--data-root", file("scans"), "--admin-token-file", file("admin")});
    const std::pair<const char*, int> names[] = {{"pipe.las", 422}, {"loop.las", 422}, {"folder.las", 422},
                                                 {"out.las", 403},  {"zero.las", 403}, {"../first.las", 403},
                                                 {"ball.las", 202}};
    for (const auto& [name, status] : names)
        EXPECT_EQ(post(port, "/api/v1/clouds", json{{"file", name}}.dump(),
                       {bearer, "Content-Type: application/json"})
                      .status,
                  status)
            << name;
    EXPECT_TRUE(becomes("/api/v1/clouds/ball/snapshot.jpg?width=32&height=16", 200)) << server->err();
}

TEST_F(AdministrationProgramTest, AConfigurationFileIsCheckedAndServed) {
    std::ofstream(folder / "serve.json")
        << json{{"files", {file("first.las")}}, {"threads", 1}, {"max-sessions", 3}};
    std::string out;
    ASSERT_EQ(run({"scancast", "serve", "--config", file("serve.json"), "--admin-token-file", file("admin"),
                   "--check-config"},
                  &out),
              0)
        << lastError;
    const json holds = json::parse(out);
    EXPECT_EQ(holds["max-sessions"], 3);
    EXPECT_EQ(holds["admin-token-file"], file("admin"));
    EXPECT_EQ(out.find(token), std::string::npos) << "no secret is printed";
    {
        const auto server = serve({"--config", file("serve.json")});
        EXPECT_EQ(statusOf("/api/v1/clouds/first"), 200);
    }
    std::ofstream(folder / "serve.json") << json{{"files", {file("first.las")}}, {"thraeds", 1}};
    EXPECT_EQ(run({"scancast", "serve", "--config", file("serve.json"), "--check-config"}), 1);
    EXPECT_THAT(lastError, HasSubstr("did you mean threads?"));
    EXPECT_EQ(
        run({"scancast", "serve", file("first.las"), "--auth-token-file", file("none"), "--check-config"}),
        1);
    EXPECT_THAT(lastError, HasSubstr("--auth-token-file"));
}

TEST_F(AdministrationProgramTest, AGuestLooksByALinkThatAnotherProgramMade) {
    std::string keys, link, shown;
    ASSERT_EQ(run({"scancast", "token", "guests-2026"}, &keys), 0) << lastError;
    std::ofstream(folder / "keys") << keys;
    fs::permissions(folder / "keys", fs::perms::owner_read | fs::perms::owner_write);
    const auto server =
        serve({file("first.las"), "--auth-token-file", file("admin"), "--guest-key-file", file("keys")});
    ASSERT_TRUE(becomes("/readyz", 200)) << server->err();
    const std::string address = "http://127.0.0.1:" + std::to_string(port) + "/";
    const std::vector<std::string> make{"scancast", "guest-link", "--key-file", file("keys"),
                                        "--url",    address,      "--expires",  "90m"};
    const auto withCloud = [&](const std::string& cloud) {
        auto command = make;
        command.insert(command.end(), {"--cloud", cloud});
        return command;
    };
    ASSERT_EQ(run(withCloud("first"), &link), 0) << lastError;
    EXPECT_THAT(link, ::testing::StartsWith(address + "#guest=scg1."));
    EXPECT_THAT(lastError, HasSubstr("good until"));
    link.pop_back();
    ASSERT_EQ(run({"scancast-client", "info", link}, &shown), 0) << lastError;
    EXPECT_THAT(shown, HasSubstr("first"));
    ASSERT_EQ(run(withCloud("second"), &link), 0) << lastError;
    link.pop_back();
    EXPECT_NE(run({"scancast-client", "snapshot", link, "--cloud", "first", "-o", file("x.jpg")}), 0);
    EXPECT_NE(run({"scancast-client", "info", address}), 0) << "and nobody else";
    EXPECT_EQ(run(withCloud("a/b")), 1);
    EXPECT_THAT(lastError, HasSubstr("--cloud"));
}

}  // namespace
}  // namespace scancast::test
