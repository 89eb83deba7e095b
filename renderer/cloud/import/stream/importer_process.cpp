#include "renderer/cloud/import/stream/importer_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "files/system_error.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t errorTextBytes = 4096;
constexpr int pipeBytes = 1 << 20;
constexpr int scanDescriptor = STDERR_FILENO + 1;  // in the importer
constexpr auto endGrace = 2s;                      // between the end of its output and the end of the process

// The sanitizers reserve terabytes at once: a limit would stop the importer at its start.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool limitsMemory = false;
#else
constexpr bool limitsMemory = true;
#endif

struct Pipe {
    UniqueFd read, write;
};

Expected<Pipe> makePipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail(ErrorCode::Io, "no pipe: " + systemReason(errno));
    return Pipe{UniqueFd(ends[0]), UniqueFd(ends[1])};
}

/// What a parser of strangers' files may know of the server's environment.
std::vector<std::string> smallEnvironment() {
    std::vector<std::string> result{"LC_ALL=C"};
    for (const char* name :
         {"PATH", "HOME", "TMPDIR", "LD_LIBRARY_PATH", "ASAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"})
        if (const char* value = std::getenv(name)) result.push_back(std::string(name) + "=" + value);
    return result;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
    std::vector<char*> result;
    for (auto& s : strings) result.push_back(s.data());
    result.push_back(nullptr);
    return result;
}

/// posix_spawn's two argument objects, released whatever happens.
struct SpawnArguments {
    posix_spawn_file_actions_t actions{};
    posix_spawnattr_t attributes{};

    SpawnArguments() {
        ::posix_spawn_file_actions_init(&actions);
        ::posix_spawnattr_init(&attributes);
    }
    ~SpawnArguments() {
        ::posix_spawn_file_actions_destroy(&actions);
        ::posix_spawnattr_destroy(&attributes);
    }
    SpawnArguments(const SpawnArguments&) = delete;
    SpawnArguments& operator=(const SpawnArguments&) = delete;
};

/// Spawning shares the parent's memory until exec: forking a server that holds gigabytes would copy its page
/// tables and stall rendering.
Expected<pid_t> spawn(std::vector<std::string> arguments, int scan, int output, int errors) {
    SpawnArguments spawn;
    ::posix_spawn_file_actions_addopen(&spawn.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&spawn.actions, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&spawn.actions, errors, STDERR_FILENO);
    // After the others: until here, one of the pipes may have this number.
    ::posix_spawn_file_actions_adddup2(&spawn.actions, scan, scanDescriptor);
    // Not every library opens its sockets with O_CLOEXEC; an importer that kept one would keep a port busy.
    ::posix_spawn_file_actions_addclosefrom_np(&spawn.actions, scanDescriptor + 1);
    sigset_t all, none;
    ::sigfillset(&all);
    ::sigdelset(&all, SIGKILL);
    ::sigdelset(&all, SIGSTOP);
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigdefault(&spawn.attributes, &all);
    ::posix_spawnattr_setsigmask(&spawn.attributes, &none);
    ::posix_spawnattr_setpgroup(&spawn.attributes, 0);
    ::posix_spawnattr_setflags(&spawn.attributes,
                               POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    auto environment = smallEnvironment();
    pid_t pid = -1;
    const int error = ::posix_spawn(&pid, arguments.front().c_str(), &spawn.actions, &spawn.attributes,
                                    pointers(arguments).data(), pointers(environment).data());
    if (error != 0)
        return fail(ErrorCode::Importer, arguments.front() + " cannot be started: " + systemReason(error));
    return pid;
}

/// The processor time allowed: far more than reading takes, so that only a program that runs in circles meets
/// it.
std::uint64_t processorSeconds(const ImportOptions& options) {
    return 60 + 12 * static_cast<std::uint64_t>(std::max(1, options.importerTimeoutSeconds));
}

/// The limits have to hold before the program's first instruction, and posix_spawn cannot set them: the shell
/// does, and becomes the program. Its script is always the same text; numbers, program and file are its
/// arguments, never part of it. A limit that cannot be set is one that is tighter already.
constexpr const char* limitsThenProgram =
    "{ ulimit -c 0; ulimit -t \"$1\"; [ -z \"$3\" ] || ulimit \"$2\" \"$3\"; } 2>/dev/null; "
    "program=$4; shift 4; exec \"$program\" \"$@\"";
constexpr int shellFoundNoProgram = 127;
constexpr int shellCannotRunProgram = 126;

std::vector<std::string> limitedCommand(const ImporterProgram& importer, const std::string& program,
                                        const std::string& file, const ImportOptions& options) {
    const bool limited = limitsMemory && options.importerMemoryLimit > 0;
    std::vector<std::string> command{
        "/bin/sh",
        "-c",
        limitsThenProgram,
        "scancast",
        std::to_string(processorSeconds(options)),
        importer.memory == ImporterProgram::Memory::Data ? "-d" : "-v",
        limited ? std::to_string(std::max<std::uint64_t>(1, options.importerMemoryLimit / 1024)) : "",
        program};
    if (options.keepAttributes && importer.knowsKeepAttributes) command.emplace_back("--keep-attributes");
    command.push_back(file);
    return command;
}

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
    const auto program = findImporter(importer.name, options);
    if (!program) return passOn(program);
    auto output = makePipe();
    if (!output) return passOn(output);
    auto errors = makePipe();
    if (!errors) return passOn(errors);
    ::fcntl(output->read.get(), F_SETPIPE_SZ, pipeBytes);  // fewer wake-ups; refused beyond the user's limit
    for (const auto& end : {output->read.get(), errors->read.get()})
        ::fcntl(end, F_SETFL, ::fcntl(end, F_GETFL) | O_NONBLOCK);

    // Beyond the standard streams, which are set up before it.
    const int opened = input.octree() ? input.octree()->descriptor() : input.file().descriptor();
    const UniqueFd scan(::fcntl(opened, F_DUPFD_CLOEXEC, scanDescriptor));
    if (!scan) return fail(ErrorCode::Io, "it cannot be handed on: " + systemReason(errno));
    const auto pid = spawn(limitedCommand(importer, program->string(), pathInImporter(input), options),
                           scan.get(), output->write.get(), errors->write.get());
    if (!pid) return passOn(pid);
    return std::unique_ptr<ImporterProcess>(
        new ImporterProcess(*pid, std::move(output->read), std::move(errors->read),
                            std::chrono::seconds(std::max(1, options.importerTimeoutSeconds))));
}

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

Expected<std::size_t> ImporterProcess::read(std::span<std::byte> into) {
    if (ended_) return std::size_t(0);
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
        bool ready = false;
        if (!waitForBytes(Clock::now() + silence_, ready)) {
            kill();
            return fail(ErrorCode::Importer,
                        fmt::format("it sent nothing for {} seconds and was stopped", silence_.count()));
        }
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
        if (signal == SIGXCPU) return "used more processor time than it is allowed";
        if (signal == SIGKILL) return "was killed by the system, which probably ran out of memory";
        const char* words = ::sigdescr_np(signal);
        return fmt::format("crashed (signal {}{}{})", signal, words ? ", " : "", words ? words : "");
    }
    if (WIFEXITED(status_) && WEXITSTATUS(status_) != 0) {
        const auto words = lastLine(errorText_);
        if (WEXITSTATUS(status_) == shellFoundNoProgram || WEXITSTATUS(status_) == shellCannotRunProgram)
            return "cannot be started" + (words.empty() ? "" : ": " + words);
        return fmt::format("ended with exit status {}{}", WEXITSTATUS(status_),
                           words.empty() ? "" : ": " + words);
    }
    return std::nullopt;
}

Expected<std::filesystem::path> findImporter(const std::string& program, const ImportOptions& options) {
    namespace fs = std::filesystem;
    std::vector<fs::path> folders;
    std::error_code error;
    if (!options.importerDirectory.empty()) {
        folders.push_back(options.importerDirectory);
    } else {
        if (const auto self = fs::read_symlink("/proc/self/exe", error); !error)
            folders.push_back(self.parent_path());
        std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
        for (std::size_t at = 0; at <= path.size();) {
            const auto end = std::min(path.find(':', at), path.size());
            // Only absolute entries: what is run must not depend on the current directory.
            if (path[at] == '/') folders.emplace_back(path.substr(at, end - at));
            at = end + 1;
        }
    }
    for (const auto& folder : folders)
        if (::access((folder / program).c_str(), X_OK) == 0) return fs::absolute(folder / program, error);
    return fail(ErrorCode::Importer,
                fmt::format("the program {} that reads this format is not there (looked in {}{})", program,
                            folders.empty() ? "no folder" : folders.front().string(),
                            folders.size() > 1 ? " and on PATH" : ""));
}

}  // namespace scancast
