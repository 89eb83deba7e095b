// Running our programs as people do: a folder for each test, output in files, nothing left running.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "protocol/frame_header.hpp"
#include "tests/integration/raw_client.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {

namespace fs = std::filesystem;

/// A program of ours, its output in files; killed when the test leaves it behind.
class Process {
  public:
    /// `before` is done in the new process, before it becomes the program.
    Process(
        const fs::path& folder, const std::vector<std::string>& arguments,
        const fs::path& input = "/dev/null", const std::function<void()>& before = [] {})
        : out_(folder / "stdout.txt"), err_(folder / "stderr.txt") {
        std::vector<std::string> words = arguments;
        words[0] = std::string(SCANCAST_BIN_DIR) + "/" + words[0];
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const std::string out = out_.string();
        const std::string err = err_.string();
        const std::string in = input.string();
        // Here, not by the new process: what another one wrote must not be taken for its output.
        for (const fs::path& one : {out_, err_}) fs::remove(one);
        pid_ = fork();
        if (pid_ == 0) {
            dup2(open(in.c_str(), O_RDONLY), 0);
            dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 1);
            dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 2);
            before();
            execv(argv[0], argv.data());
            _exit(127);
        }
    }
    ~Process() {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    void signal(int number) const { kill(pid_, number); }
    /// Its exit code; -1 when it does not end in time or is killed by a signal.
    int wait(std::chrono::seconds patience = std::chrono::seconds(60)) {
        const auto end = std::chrono::steady_clock::now() + patience;
        int status = 0;
        while (waitpid(pid_, &status, WNOHANG) == 0) {
            if (std::chrono::steady_clock::now() > end) return -1;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::string out() const { return contentOf(out_); }
    std::string err() const { return contentOf(err_); }

  private:
    fs::path out_, err_;
    pid_t pid_ = -1;
};

/// Acknowledges frames until the final still of view `seq` (0 = the first view, or any) comes.
inline void receiveFinal(RawWebSocket& stream, std::uint64_t seq, std::string& picture,
                         FrameHeader* last = nullptr) {
    FrameHeader header;
    while (!(header.final && (seq == 0 || header.seq == seq))) {
        const WsMessage message = stream.receiveKind(WsMessage::Kind::Binary);
        ASSERT_EQ(message.kind, WsMessage::Kind::Binary) << "no final still came";
        const auto parsed = parseFrame(
            {reinterpret_cast<const std::uint8_t*>(message.payload.data()), message.payload.size()});
        ASSERT_TRUE(parsed) << parsed.error().message;
        header = parsed->header;
        if (last != nullptr) *last = header;
        picture.assign(parsed->picture.begin(), parsed->picture.end());
        stream.text(R"({"type":"ack","frame":)" + std::to_string(header.frameId) + "}");
    }
}

class ProgramTest : public ::testing::Test {
  protected:
    /// Runs a program to its end.
    int run(
        const std::vector<std::string>& arguments, std::string* out = nullptr,
        const std::function<void()>& before = [] {}) {
        Process process(folder, arguments, "/dev/null", before);
        const int code = process.wait();
        if (out != nullptr) *out = process.out();
        lastError = process.err();
        return code;
    }
    std::string file(const std::string& name) const { return (folder / name).string(); }
    void generate(const std::string& name, const std::string& scene = "sphere") {
        ASSERT_EQ(run({"scancast", "generate", scene, "--points", "20000", "-o", file(name)}), 0)
            << lastError;
    }
    /// Starts a server and waits until it is ready, or answers `until`; its files are in a folder of their own.
    std::unique_ptr<Process> serve(
        std::vector<std::string> arguments, const std::function<void()>& before = [] {},
        const std::string& until = "/readyz") {
        fs::create_directories(folder / "server");
        arguments.insert(arguments.begin(), {serverProgram, "serve", "--port", "0"});
        auto process = std::make_unique<Process>(folder / "server", arguments, "/dev/null", before);
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            const std::string out = process->out();
            const auto at = out.find("http://127.0.0.1:");
            if (at != std::string::npos && out.find('\n', at) != std::string::npos) {
                url = out.substr(at, out.find('\n', at) - at);
                port = std::uint16_t(std::stoi(url.substr(17)));
                if (request(port, until).status == 200) return process;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        ADD_FAILURE() << "the server never became ready: " << process->out() << process->err();
        return process;
    }

    const TemporaryFolder folder;
    std::string serverProgram = "scancast";  ///< beside the other programs
    std::string url, lastError;
    std::uint16_t port = 0;
};

}  // namespace scancast::test
