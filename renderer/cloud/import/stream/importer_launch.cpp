#include "renderer/cloud/import/stream/importer_launch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <thread>

#include "files/system_error.hpp"
#include "threads/guarded.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

constexpr int pipeBytes = 1 << 20;
constexpr const char* launcherName = "scancast-sandbox";

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
    for (const char* name : {"PATH", "LD_LIBRARY_PATH", "ASAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"})
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
Expected<pid_t> spawn(std::vector<std::string> arguments, int scan, int input, int output, int errors) {
    SpawnArguments spawn;
    if (input >= 0)
        ::posix_spawn_file_actions_adddup2(&spawn.actions, input, STDIN_FILENO);
    else
        ::posix_spawn_file_actions_addopen(&spawn.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&spawn.actions, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&spawn.actions, errors, STDERR_FILENO);
    // After the others: until here, one of the pipes may have this number.
    if (scan >= 0) ::posix_spawn_file_actions_adddup2(&spawn.actions, scan, scanDescriptor);
    // Not every library opens its sockets with O_CLOEXEC; an importer that kept one would keep a port busy.
    ::posix_spawn_file_actions_addclosefrom_np(&spawn.actions,
                                               scan >= 0 ? scanDescriptor + 1 : scanDescriptor);
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

/// A thread that starts processes, and lasts as long as this one does: the kernel ends an importer with the thread that started
/// it, and those that read come and go. Never deleted; it is detached.
class Starter {
  public:
    static Starter& instance() {
        static Starter* const starter = new Starter;
        return *starter;
    }
    Expected<pid_t> start(const std::function<Expected<pid_t>()>& work) {
        const std::lock_guard turn(turn_);
        std::unique_lock lock(mutex_);
        work_ = &work;
        changed_.notify_all();
        changed_.wait(lock, [this] { return work_ == nullptr; });
        return std::move(result_);
    }

  private:
    Starter() {
        std::thread([this] { run(); }).detach();
    }
    [[noreturn]] void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return work_ != nullptr; });
            result_ = guarded("Starting an importer", *work_);
            work_ = nullptr;
            changed_.notify_all();
        }
    }

    std::mutex turn_;   // of those who ask
    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    const std::function<Expected<pid_t>()>* work_ = nullptr;
    Expected<pid_t> result_ = fail(ErrorCode::Internal, {});
};

std::vector<fs::path> besideAndOnPath() {
    std::vector<fs::path> folders;
    std::error_code error;
    if (const auto self = fs::read_symlink("/proc/self/exe", error); !error)
        folders.push_back(self.parent_path());
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    for (std::size_t at = 0; at <= path.size();) {
        const auto end = std::min(path.find(':', at), path.size());
        // Only absolute entries: what is run must not depend on the current directory.
        if (path[at] == '/') folders.emplace_back(path.substr(at, end - at));
        at = end + 1;
    }
    return folders;
}

Expected<fs::path> findIn(const std::vector<fs::path>& folders, const std::string& program,
                          const std::string& what) {
    std::error_code error;
    for (const auto& folder : folders)
        if (::access((folder / program).c_str(), X_OK) == 0) return fs::absolute(folder / program, error);
    return fail(ErrorCode::Importer,
                fmt::format("the program {} that {} is not there (looked in {}{})", program, what,
                            folders.empty() ? "no folder" : folders.front().string(),
                            folders.size() > 1 ? " and on PATH" : ""));
}

}  // namespace

Expected<LaunchedProgram> launch(std::vector<std::string> arguments, int scan, ProgramInput given) {
    auto output = makePipe();
    if (!output) return passOn(output);
    auto errors = makePipe();
    if (!errors) return passOn(errors);
    Pipe input;
    if (given == ProgramInput::Pipe) {
        auto made = makePipe();
        if (!made) return passOn(made);
        input = std::move(*made);
        ::fcntl(input.write.get(), F_SETPIPE_SZ, pipeBytes);
        ::fcntl(input.write.get(), F_SETFL, ::fcntl(input.write.get(), F_GETFL) | O_NONBLOCK);
    }
    ::fcntl(output->read.get(), F_SETPIPE_SZ, pipeBytes);  // fewer wake-ups; refused beyond the user's limit
    for (const auto& end : {output->read.get(), errors->read.get()})
        ::fcntl(end, F_SETFL, ::fcntl(end, F_GETFL) | O_NONBLOCK);
    UniqueFd aside;
    if (scan >= 0) {
        // Beyond the standard streams, which are set up before it.
        aside.reset(::fcntl(scan, F_DUPFD_CLOEXEC, scanDescriptor));
        if (!aside) return fail(ErrorCode::Io, "it cannot be handed on: " + systemReason(errno));
    }
    const auto pid = Starter::instance().start([&] {
        return spawn(std::move(arguments), aside.get(), input.read.get(), output->write.get(),
                     errors->write.get());
    });
    if (!pid) return passOn(pid);
    return LaunchedProgram{*pid, std::move(output->read), std::move(errors->read), std::move(input.write)};
}

Expected<std::vector<std::string>> importerCommand(const ImporterProgram& importer, const std::string& file,
                                                   const ImportOptions& options) {
    const auto program = findImporter(importer.name, options);
    if (!program) return passOn(program);
    const auto launcher = findSandbox(options);
    if (!launcher) return passOn(launcher);
    std::vector<std::string> command{launcher->string(), "--parent", std::to_string(::getpid()), "--sandbox",
                                     std::string(name(options.importerSandbox))};
    const auto limit = [&](const char* flag, std::uint64_t value) {
        if (value == 0) return;
        command.emplace_back(flag);
        command.push_back(std::to_string(value));
    };
    limit("--seconds", options.importerProcessorSeconds);
    if (limitsMemory && options.importerMemoryLimit > 0)
        limit("--addresses", std::max<std::uint64_t>(1, options.importerMemoryLimit / 1024));
    command.push_back(program->string());
    if (options.keepAttributes && importer.knowsKeepAttributes) command.emplace_back("--keep-attributes");
    if (options.recover && importer.knowsRecover) command.emplace_back("--recover");
    command.push_back(file);
    return command;
}

Expected<fs::path> findImporter(const std::string& program, const ImportOptions& options) {
    const std::vector<fs::path> named{options.importerDirectory};
    return findIn(options.importerDirectory.empty() ? besideAndOnPath() : named, program,
                  "reads this format");
}

Expected<fs::path> findSandbox(const ImportOptions& options) {
    auto folders = besideAndOnPath();
    if (!options.importerDirectory.empty()) folders.insert(folders.begin(), options.importerDirectory);
    return findIn(folders, launcherName, "importers are started by");
}

}  // namespace scancast
