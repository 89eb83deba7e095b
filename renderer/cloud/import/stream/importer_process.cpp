#include "renderer/cloud/import/stream/importer_process.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include "files/system_error.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/importer_launch.hpp"

namespace scancast {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t errorTextBytes = 4096;
constexpr auto endGrace = 2s;         // between the end of its output and the end of the process
constexpr auto lookInterval = 250ms;  // at what it reads, and whether somebody wants it to stop
// What scancast-sandbox, like a shell, says of a program that it cannot become.
constexpr int foundNoProgram = 127, cannotRunProgram = 126;

/// Opening it anew gives the importer a place of its own in the file, and, unlike a name, always the same
/// file.
std::string pathInImporter(const ScanInput& input) {
    const std::string opened = "/proc/self/fd/" + std::to_string(scanDescriptor);
    return input.octree() ? opened + "/" + input.file().name().filename().string() : opened;
}

std::string lastLine(const std::string& text) {
    const auto trimmed = printableText(text, errorTextBytes * 2);
    const auto start = trimmed.find_last_of('\n');
    return trimmed.substr(start == std::string::npos ? 0 : start + 1).substr(0, 300);
}

}  // namespace

Expected<std::unique_ptr<ImporterProcess>> ImporterProcess::start(const ImporterProgram& importer,
                                                                  const ScanInput& input,
                                                                  const ImportOptions& options) {
    auto command = importerCommand(importer, pathInImporter(input), options);
    if (!command) return passOn(command);
    auto launched = launch(std::move(*command),
                           input.octree() ? input.octree()->descriptor() : input.file().descriptor());
    if (!launched) return passOn(launched);
    return std::make_unique<ImporterProcess>(
        std::move(*launched), std::chrono::seconds(std::max(1, options.importerSilenceSeconds)),
        options.stop);
}

ImporterProcess::ImporterProcess(LaunchedProgram program, std::chrono::seconds silence, std::stop_token stop)
    : pid_(program.pid),
      output_(std::move(program.output)),
      errors_(std::move(program.errors)),
      silence_(silence),
      stop_(std::move(stop)) {}

ImporterProcess::~ImporterProcess() {
    kill();
    reap(Clock::now() + 10s);
}

void ImporterProcess::kill() {
    // The group goes by the leader's number, which stays taken until the leader is waited for.
    if (!reaped_) ::kill(-pid_, SIGKILL);
}

void ImporterProcess::readErrors() {
    std::array<char, 4096> piece{};
    const auto got = ::read(errors_.get(), piece.data(), piece.size());
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got <= 0) {
        errors_.reset();
        return;
    }
    errorText_.append(piece.data(), static_cast<std::size_t>(got));
    if (errorText_.size() > errorTextBytes) errorText_.erase(0, errorText_.size() - errorTextBytes);
}

/// Waits for output, taking in what comes on standard error meanwhile. False at the deadline.
bool ImporterProcess::waitForBytes(Clock::time_point deadline, bool& outputReady) {
    outputReady = false;
    while (!outputReady) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0) return false;
        std::array<pollfd, 2> ends{pollfd{ended_ ? -1 : output_.get(), POLLIN, 0},
                                   pollfd{errors_.get(), POLLIN, 0}};
        if (ended_ && !errors_) return true;
        const int ready = ::poll(ends.data(), ends.size(), static_cast<int>(std::min<long long>(left, 1000)));
        if (ready < 0 && errno != EINTR) return false;
        if (ready <= 0) continue;
        if (ends[1].revents != 0) readErrors();
        outputReady = ends[0].revents != 0;
    }
    return true;
}

/// Whether it gets on with its file, though it says nothing yet: what the kernel counts as read, from anywhere or from the
/// disk (which is how memory that maps a file is filled).
bool ImporterProcess::hasReadMore() {
    std::ifstream counts(fmt::format("/proc/{}/io", pid_));
    std::uint64_t sum = 0, value = 0;
    for (std::string name; counts >> name >> value;)
        if (name == "rchar:" || name == "read_bytes:") sum += value;
    return sum > std::exchange(taken_, sum);
}

Expected<std::size_t> ImporterProcess::read(std::span<std::byte> into) {
    if (ended_) return std::size_t(0);
    auto deadline = Clock::now() + silence_;
    for (;;) {
        const auto got = ::read(output_.get(), into.data(), into.size());
        if (got > 0) return static_cast<std::size_t>(got);
        if (got == 0) {
            ended_ = true;
            return std::size_t(0);
        }
        if (errno == EINTR) continue;
        if (errno != EAGAIN)
            return fail(ErrorCode::Importer, "its output cannot be read: " + systemReason(errno));
        if (stop_.stop_requested()) {
            kill();
            return fail(ErrorCode::Cancelled, "reading it was given up");
        }
        bool ready = false;
        if (waitForBytes(std::min(deadline, Clock::now() + lookInterval), ready)) continue;
        if (hasReadMore()) deadline = Clock::now() + silence_;
        if (Clock::now() < deadline) continue;
        kill();
        return fail(
            ErrorCode::Importer,
            fmt::format("it hangs: it sent nothing for {} seconds, read nothing of its file, and was stopped "
                        "(--importer-silence says how long it may)",
                        silence_.count()));
    }
}

bool ImporterProcess::reap(Clock::time_point deadline) {
    while (!reaped_) {
        const auto found = ::waitpid(pid_, &status_, WNOHANG);
        if (found == pid_ || (found < 0 && errno != EINTR)) {
            reaped_ = true;
        } else {
            if (Clock::now() >= deadline) return false;
            std::this_thread::sleep_for(2ms);
        }
    }
    return true;
}

std::optional<std::string> ImporterProcess::badEnd() {
    const auto deadline = Clock::now() + endGrace;
    bool unused = false;
    if (ended_) waitForBytes(deadline, unused);  // the last words on standard error
    if (!ended_ || !reap(deadline)) return std::nullopt;
    if (WIFSIGNALED(status_)) {
        const int signal = WTERMSIG(status_);
        if (signal == SIGXCPU) return "used more processor time than it is allowed (--importer-time)";
        if (signal == SIGSYS) return "made a system call that importers may not make, and was ended";
        if (signal == SIGKILL) return "was killed by the system, which probably ran out of memory";
        const char* words = ::sigdescr_np(signal);
        return fmt::format("crashed (signal {}{}{})", signal, words ? ", " : "", words ? words : "");
    }
    if (WIFEXITED(status_) && WEXITSTATUS(status_) != 0) {
        const auto words = lastLine(errorText_);
        if (WEXITSTATUS(status_) == foundNoProgram && words.starts_with("/usr/bin/env: ") &&
            words.find("node") != std::string::npos)
            return "cannot be started: Node.js is missing; apt-get install nodejs";
        if (WEXITSTATUS(status_) == foundNoProgram || WEXITSTATUS(status_) == cannotRunProgram)
            return "cannot be started" + (words.empty() ? "" : ": " + words);
        return fmt::format("ended with exit status {}{}", WEXITSTATUS(status_),
                           words.empty() ? "" : ": " + words);
    }
    return std::nullopt;
}

}  // namespace scancast
