// `scancast doctor` on machines that are well and on machines that are not: each thing that can be wrong is made wrong once.
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/integration/program_fixture.hpp"
#include "tests/support/serving/test_certificate.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class DoctorProgramTest : public ProgramTest {
  protected:
    void SetUp() override { generate("ball.las"); }
    /// Runs it, told this; what it exits with goes with what it says.
    void examine(
        std::vector<std::string> arguments, const std::function<void()>& before = [] {}) {
        arguments.insert(arguments.begin(), {program, "doctor", "--json"});
        std::string out;
        const int code = run(arguments, &out, before);
        said = json::parse(out, nullptr, false);
        ASSERT_TRUE(said.is_object()) << code << out << lastError;
        EXPECT_EQ(code, said["sound"] == true ? 0 : 1);
        bool faults = false;
        for (const json& one : said["findings"]) {
            faults = faults || one["verdict"] == "fault";
            EXPECT_EQ(one.contains("mend"), one["verdict"] != "ok") << one;
        }
        EXPECT_EQ(said["sound"], !faults);
    }
    /// The text of what was found of that topic with that verdict; empty when there is none.
    std::string found(const std::string& topic, const std::string& verdict) const {
        for (const json& one : said["findings"])
            if (one["topic"] == topic && one["verdict"] == verdict) return one["text"];
        return {};
    }
    std::string secret(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name) << text;
        fs::permissions(folder / name, fs::perms::owner_read | fs::perms::owner_write);
        return file(name);
    }
    std::string program = "scancast";
    json said;
};

TEST_F(DoctorProgramTest, AMachineThatIsWell) {
    ASSERT_EQ(run({"scancast", "ingest", file("ball.las"), "-o", file("ball.scan")}), 0) << lastError;
    const auto certificate = makeCertificate(folder, "server", -60, 90 * 86400);
    const std::string token = secret("token", "alice Zk3vQ9xT1mB7nR4sW8yH2cL6pF0dJ5gA\n");
    fs::create_directory(folder / "cache");
    examine({file("ball.las"), file("ball.scan"), "--port", "0", "--backend", "cpu", "--cache-dir",
             file("cache"), "--auth-token-file", token, "--tls-cert", certificate.certificate.string(),
             "--tls-key", certificate.key.string(), "--memory-limit", "256M"});
    EXPECT_EQ(said["sound"], true) << said;
    for (const char* topic : {"version", "flags", "draws", "memory", "processors", "open files", "listens",
                              "tokens", "certificate", "cache", "clouds"})
        EXPECT_NE(found(topic, "ok"), "") << topic << said;
    EXPECT_THAT(found("clouds", "ok"), HasSubstr("20000 points"));
    EXPECT_THAT(found("tokens", "ok"), HasSubstr("1 of users"));
    std::string text;
    EXPECT_EQ(run({"scancast", "doctor", "--port", "0"}, &text), 0) << text;
    EXPECT_THAT(text, HasSubstr("ok       version"));
}

TEST_F(DoctorProgramTest, APortThatSomebodyHas) {
    const int other = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    ASSERT_EQ(::bind(other, reinterpret_cast<sockaddr*>(&address), length), 0);
    ASSERT_EQ(::listen(other, 1), 0);
    ::getsockname(other, reinterpret_cast<sockaddr*>(&address), &length);
    const std::string taken = std::to_string(ntohs(address.sin_port));
    examine({"--port", taken});
    EXPECT_THAT(found("listens", "fault"), HasSubstr("(process " + std::to_string(::getpid()) + ")"));
    examine({"--port", "0", "--admin-listen", "127.0.0.1:" + taken});
    EXPECT_THAT(found("listens", "fault"), HasSubstr("127.0.0.1:" + taken));
    ::close(other);
    const auto server = serve({file("ball.las")});
    examine({"--port", std::to_string(port)});
    EXPECT_THAT(found("listens", "warning"), HasSubstr("scancast listens")) << "perhaps it is meant";
    examine({"--port", "0", "--host", "192.0.2.1", "--insecure"});
    EXPECT_NE(found("listens", "fault"), "") << "no address of this machine";
}

TEST_F(DoctorProgramTest, TokensAndCertificates) {
    const std::string weak = secret("weak", "password\n"),
                      open = secret("open", "a Zk3vQ9xT1mB7nR4sW8yH2cL6pF0dJ5gA\n");
    fs::permissions(open, fs::perms::others_read, fs::perm_options::add);
    examine({"--port", "0", "--auth-token-file", weak});
    EXPECT_THAT(found("tokens", "fault"), HasSubstr("could be guessed"));
    examine({"--port", "0", "--auth-token-file", open});
    EXPECT_THAT(found("tokens", "fault"), HasSubstr("chmod 600"));
    examine({"--port", "0", "--host", "0.0.0.0", "--insecure"});
    EXPECT_NE(found("tokens", "warning"), "");
    EXPECT_NE(found("certificate", "warning"), "");
    const auto old = makeCertificate(folder, "old", -7200, -3600),
               soon = makeCertificate(folder, "soon", -60, 86400);
    examine({"--port", "0", "--tls-cert", old.certificate.string(), "--tls-key", old.key.string()});
    EXPECT_THAT(found("certificate", "fault"), HasSubstr("expired"));
    examine({"--port", "0", "--tls-cert", soon.certificate.string(), "--tls-key", soon.key.string()});
    EXPECT_THAT(found("certificate", "warning"), HasSubstr("expires at"));
}

TEST_F(DoctorProgramTest, Limits) {
    examine({"--port", "0", "--memory-limit", "1M"});
    EXPECT_THAT(found("memory", "fault"), HasSubstr("64M"));
    examine({"--port", "0", "--memory-limit", "4000000G"});
    EXPECT_THAT(found("memory", "warning"), HasSubstr("more than there is"));
    examine({"--port", "0", "--threads", "1024"});
    EXPECT_THAT(found("processors", "warning"), HasSubstr("1024"));
    const auto fewFiles = [] {
        const rlimit few{500, 500};
        ::setrlimit(RLIMIT_NOFILE, &few);
    };
    examine({"--port", "0", "--max-connections", "1000"}, fewFiles);
    EXPECT_NE(found("open files", "fault"), "");
    examine({"--port", "0", "--max-sessions", "8"}, fewFiles);
    EXPECT_NE(found("open files", "warning"), "");
    examine({"--port", "0", "--backend", "egl", "--egl-device", "99"});
    EXPECT_THAT(found("draws", "fault"), HasSubstr("--egl-device=99"));
}

TEST_F(DoctorProgramTest, FoldersThatAreNotThereOrNotForThisUser) {
    examine({"--port", "0", "--cache-dir", file("none")});
    EXPECT_THAT(found("cache", "fault"), HasSubstr("there is no folder"));
    EXPECT_NE(found("flags", "fault"), "") << "as serve says it";
    examine({"--port", "0", "--cache-dir", "/proc"});
    EXPECT_THAT(found("cache", "fault"), HasSubstr("cannot be written to"));
    fs::create_directory(folder / "open");
    fs::permissions(folder / "open", fs::perms::all);
    examine({"--port", "0", "--cache-dir", file("open")});
    EXPECT_THAT(found("cache", "warning"), HasSubstr("by everybody"));
    examine({"--port", "0"}, [] { ::setenv("TMPDIR", "/no/such/folder", 1); });
    EXPECT_THAT(found("temporary", "fault"), HasSubstr("/no/such/folder"));
    examine({"--port", "0", "--data-root", file("none")});
    EXPECT_THAT(found("data root", "fault"), HasSubstr("there is no folder"));
}

TEST_F(DoctorProgramTest, CloudsAndConfigurations) {
    ASSERT_EQ(run({"scancast", "ingest", file("ball.las"), "-o", file("cut.scan")}), 0) << lastError;
    fs::resize_file(folder / "cut.scan", fs::file_size(folder / "cut.scan") - 100);
    examine({"--port", "0", file("cut.scan")});
    EXPECT_THAT(found("clouds", "fault"), HasSubstr("cut.scan"));
    examine({"--port", "0", file("none.las")});
    EXPECT_THAT(found("clouds", "fault"), HasSubstr("none.las"));
    std::ofstream(folder / "config.json") << R"({"prot": 1})";
    examine({"--port", "0", "--config", file("config.json")});
    EXPECT_THAT(found("configuration", "fault"), HasSubstr("did you mean port?"));
    std::ofstream(folder / "config.json") << R"({"port": 0, "files": [")" << file("none.las") << R"("]})";
    examine({"--config", file("config.json")});
    EXPECT_THAT(found("clouds", "fault"), HasSubstr("none.las")) << "of the file";
}

TEST_F(DoctorProgramTest, ImportersThatAreNotThere) {
    // Beside the program, in a folder of its own on the same disk, is nothing.
    const fs::path lonely =
        fs::path(SCANCAST_BIN_DIR).parent_path() / ("doctor-" + std::to_string(::getpid()));
    fs::create_directory(lonely);
    fs::create_hard_link(fs::path(SCANCAST_BIN_DIR) / "scancast", lonely / "scancast");
    program = "../" + lonely.filename().string() + "/scancast";
    examine({"--port", "0"}, [] { ::setenv("PATH", "/no/such/folder", 1); });
    fs::remove_all(lonely);
    EXPECT_THAT(found("importers", "warning"), HasSubstr("scancast-import-pcl is not there"));
    EXPECT_THAT(found("sandbox", "warning"), HasSubstr("scancast-sandbox"));
    program = "scancast";
    examine({"--port", "0", "--importer-sandbox", "off"});
    EXPECT_THAT(found("sandbox", "warning"), HasSubstr("importers are not shut in (--importer-sandbox=off)"));
}

}  // namespace
}  // namespace scancast::test
