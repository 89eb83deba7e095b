// SIGHUP as administrators send it to a running server: what is sound of tokens, certificate and the list of clouds is
// taken, what is not stays as it was, and nobody who is connected notices.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/integration/operation/tls_client.hpp"
#include "tests/integration/program_fixture.hpp"
#include "tests/support/serving/notify_socket.hpp"
#include "tests/support/serving/test_certificate.hpp"

namespace scancast::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string firstToken = "Zk3vQ9xT1mB7nR4sW8yH2cL6pF0dJ5gA",
                  secondToken = "q7Lw2NfXr5Yt8Ds1Gh4Jk6Mv9Bc3Pz0E";

class ReloadProgramTest : public ProgramTest {
  protected:
    void SetUp() override {
        generate("first.las");
        fs::copy_file(file("first.las"), file("second.las"));
        write("token", "alice " + firstToken + "\n");
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name) << text;
        fs::permissions(folder / name, fs::perms::owner_read | fs::perms::owner_write);
    }
    /// A configuration of these files, and more of such an object.
    void configure(const std::vector<std::string>& files, const std::string& more = "") const {
        std::string list;
        for (const std::string& one : files) list += (list.empty() ? "\"" : ", \"") + file(one) + "\"";
        write("config.json",
              "{\"files\": [" + list + "], \"auth-token-file\": \"" + file("token") + "\"" + more + "}");
    }
    static std::size_t linesOf(const Process& server) {
        const std::string log = server.err();
        std::size_t count = 0;
        for (auto at = log.find("Reloaded: "); at != std::string::npos; at = log.find("Reloaded: ", at + 1))
            ++count;
        return count;
    }
    /// Sends it, and waits for the line at the end; returns that line.
    static std::string reload(const Process& server) {
        const std::size_t before = linesOf(server);
        server.signal(SIGHUP);
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (linesOf(server) == before && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        const std::string log = server.err();
        const auto at = log.rfind("Reloaded: ");
        return at == std::string::npos ? "" : log.substr(at, log.find('\n', at) - at);
    }
    HttpReply ask(const std::string& target, const std::string& token) const {
        return request(port, target, {"Authorization: Bearer " + token});
    }
    bool becomes(const std::string& target, int status, const std::string& token) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (ask(target, token).status != status) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return true;
    }
};

TEST_F(ReloadProgramTest, TokensAreOthersAndUnsoundOnesAreNotTaken) {
    configure({"first.las"});
    const auto server = serve({"--config", file("config.json")});
    EXPECT_EQ(ask("/api/v1/clouds", firstToken).status, 200);
    write("token", "bob " + secondToken + "\n");
    EXPECT_THAT(reload(*server), HasSubstr("tokens (1 of users, 0 of administrators)"));
    EXPECT_EQ(ask("/api/v1/clouds", firstToken).status, 401);
    EXPECT_EQ(ask("/api/v1/clouds", secondToken).status, 200);
    write("token", "bob password\n");
    EXPECT_THAT(reload(*server), AllOf(HasSubstr("nothing has changed"), HasSubstr("as before: the tokens")));
    EXPECT_EQ(ask("/api/v1/clouds", secondToken).status, 200);
    EXPECT_THAT(server->err(), AllOf(HasSubstr("could be guessed"), Not(HasSubstr("password\n"))));
    const std::string metrics = ask("/metrics", secondToken).body;
    EXPECT_THAT(metrics, HasSubstr("scancast_reloads_total{outcome=\"applied\"} 1\n"));
    EXPECT_THAT(metrics, HasSubstr("scancast_reloads_total{outcome=\"refused\"} 1\n"));
}

TEST_F(ReloadProgramTest, CloudsComeGoAndAreTriedAgain) {
    configure({"first.las", "late.las"});
    const auto server = serve({"--config", file("config.json")});
    EXPECT_EQ(ask("/api/v1/clouds/late", firstToken).status, 404) << "it could not be loaded";
    fs::copy_file(file("first.las"), file("late.las"));
    EXPECT_THAT(reload(*server), HasSubstr("1 cloud tried again"));
    EXPECT_TRUE(becomes("/api/v1/clouds/late", 200, firstToken)) << server->err();
    configure({"late.las", "second.las"});
    EXPECT_THAT(reload(*server), HasSubstr("1 cloud added, 1 cloud removed"));
    EXPECT_EQ(ask("/api/v1/clouds/first", firstToken).status, 404);
    EXPECT_TRUE(becomes("/api/v1/clouds/second/snapshot.jpg?width=32&height=16", 200, firstToken));
    EXPECT_EQ(ask("/api/v1/clouds/late/snapshot.jpg?width=32&height=16", firstToken).status, 200)
        << "it stays";
    EXPECT_THAT(reload(*server), HasSubstr("Reloaded: nothing has changed."));
}

TEST_F(ReloadProgramTest, FoldersAreLookedThroughAgain) {
    fs::create_directory(file("scans"));
    fs::copy_file(file("first.las"), file("scans/a.las"));
    configure({"scans"});
    const auto server = serve({"--config", file("config.json")});
    EXPECT_TRUE(becomes("/api/v1/clouds/a", 200, firstToken)) << server->err();
    fs::copy_file(file("second.las"), file("scans/b.las"));
    EXPECT_THAT(reload(*server), HasSubstr("1 cloud added"));
    EXPECT_TRUE(becomes("/api/v1/clouds/b", 200, firstToken)) << server->err();
    fs::remove(file("scans/a.las"));
    EXPECT_THAT(reload(*server), HasSubstr("1 cloud removed"));
    fs::remove(file("scans/b.las"));
    EXPECT_THAT(reload(*server), HasSubstr("as before: the configuration"))
        << "nothing to serve is a mistake";
}

TEST_F(ReloadProgramTest, AConfigurationThatIsUnsoundChangesNothingAndWhatNeedsARestartIsNamed) {
    configure({"first.las"});
    const auto server = serve({"--config", file("config.json"), "--max-sessions", "7"});
    write("config.json", "{\"files\": [\"" + file("second.las") + "\"], \"prot\": 1}");
    write("token", "bob " + secondToken + "\n");
    EXPECT_THAT(reload(*server), AllOf(HasSubstr("tokens"), HasSubstr("as before: the configuration")));
    EXPECT_THAT(server->err(), HasSubstr("\"prot\""));
    EXPECT_EQ(ask("/api/v1/clouds/first", secondToken).status, 200);
    configure({"first.las"}, ", \"max-pixels\": 1000000, \"max-sessions\": 9");
    const std::string line = reload(*server);
    EXPECT_THAT(line, HasSubstr("restart for --max-pixels."));
    EXPECT_THAT(line, Not(HasSubstr("max-sessions"))) << "the command line goes before the file";
}

// What it listens on, it listens on until it is restarted.
TEST_F(ReloadProgramTest, ATokenIsNotGivenUpForAnAddressThatHoldsAfterARestart) {
    configure({"first.las"}, ", \"admin-listen\": \"0.0.0.0:0\"");
    const auto server = serve({"--config", file("config.json")});
    write("config.json", "{\"files\": [\"" + file("first.las") + "\"]}");
    EXPECT_THAT(reload(*server), HasSubstr("as before: the configuration"));
    EXPECT_THAT(server->err(), HasSubstr("as long as it is not restarted, --admin-listen"));
    EXPECT_EQ(request(port, "/api/v1/clouds").status, 401);
}

TEST_F(ReloadProgramTest, TheServiceManagerHearsWhenItBeginsAndWhenItIsDone) {
    const NotifySocket manager(file("notify"));
    configure({"first.las"});
    const auto server = serve({"--config", file("config.json")},
                              [&] { ::setenv("NOTIFY_SOCKET", manager.name().c_str(), 1); });
    ASSERT_TRUE(manager.until("READY=1\n"));
    server->signal(SIGHUP);
    ASSERT_TRUE(manager.until("RELOADING=1\nMONOTONIC_USEC="));
    ASSERT_TRUE(manager.until("READY=1\n"));
    server->signal(SIGUSR1);
    server->signal(SIGTERM);
    EXPECT_EQ(const_cast<Process&>(*server).wait(), 0);
}

TEST_F(ReloadProgramTest, CertificatesAreOthersForWhoComesAndUnsoundOnesAreNotShown) {
    auto now = makeCertificate(folder, "server", -60, 86400);
    const auto next = makeCertificate(folder, "next", -60, 90 * 86400),
               expired = makeCertificate(folder, "expired", -7200, -3600);
    fs::create_directories(folder / "server");
    Process server(folder / "server", {"scancast", "serve", file("first.las"), "--port", "0", "--tls-cert",
                                       now.certificate.string(), "--tls-key", now.key.string()});
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    const std::string start = "https://127.0.0.1:";
    std::size_t at = std::string::npos;
    while ((at = server.out().find(start)) == std::string::npos ||
           server.out().find('\n', at) == std::string::npos) {
        ASSERT_LT(std::chrono::steady_clock::now(), end) << server.err();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    port = std::uint16_t(std::stoi(server.out().substr(at + start.size())));
    TlsClient before(port);
    ASSERT_THAT(before.get("/healthz"), HasSubstr("200"));
    EXPECT_THAT(server.err(), HasSubstr("expires at")) << "a day is left";
    const auto install = [&](const CertificateFiles& files) {
        fs::copy_file(files.certificate, now.certificate, fs::copy_options::overwrite_existing);
        fs::copy_file(files.key, now.key, fs::copy_options::overwrite_existing);
    };
    install(next);
    EXPECT_THAT(reload(server), HasSubstr("certificate (until "));
    TlsClient after(port);
    EXPECT_NE(after.digest(), before.digest());
    install(expired);
    EXPECT_THAT(reload(server), HasSubstr("as before: the certificate"));
    EXPECT_THAT(server.err(), HasSubstr("expired at"));
    EXPECT_EQ(TlsClient(port).digest(), after.digest());
    EXPECT_THAT(before.get("/healthz"), HasSubstr("200")) << "it was there before all that";
}

}  // namespace
}  // namespace scancast::test
