#include "ranks/front/job_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

/// mpirun ends its ranks in less, and puts away what they shared.
constexpr auto endsWithin = std::chrono::seconds(2);
constexpr auto looksForEndEvery = std::chrono::milliseconds(10);

/// Ranks have nothing to put away when they are told to end; Open MPI would wait a second before it looks whether they have.
constexpr std::string_view noGrace = "OMPI_MCA_odls_base_sigkill_timeout";

struct JobSpawn {
    posix_spawn_file_actions_t actions{};
    posix_spawnattr_t attributes{};

    JobSpawn() {
        ::posix_spawn_file_actions_init(&actions);
        ::posix_spawnattr_init(&attributes);
    }
    ~JobSpawn() {
        ::posix_spawn_file_actions_destroy(&actions);
        ::posix_spawnattr_destroy(&attributes);
    }
    JobSpawn(const JobSpawn&) = delete;
    JobSpawn& operator=(const JobSpawn&) = delete;
};

std::vector<char*> jobPointers(std::vector<std::string>& strings) {
    std::vector<char*> result;
    for (auto& s : strings) result.push_back(s.data());
    result.push_back(nullptr);
    return result;
}

std::vector<std::string> jobEnvironment() {
    std::vector<std::string> all;
    for (char** variable = environ; *variable != nullptr; ++variable) all.emplace_back(*variable);
    if (std::getenv(noGrace.data()) == nullptr) all.push_back(std::string(noGrace) + "=0");
    return all;
}

}  // namespace

Expected<std::vector<std::string>> wordsOfLine(const std::string& line) {
    std::vector<std::string> words;
    char quotation = 0;
    bool inWord = false;
    for (const char c : line) {
        if (quotation != 0 && c == quotation) {
            quotation = 0;
        } else if (quotation != 0) {
            words.back().push_back(c);
        } else if (c == ' ' || c == '\t' || c == '\n') {
            inWord = false;
        } else {
            if (!std::exchange(inWord, true)) words.emplace_back();
            if (c == '\'' || c == '"')
                quotation = c;
            else
                words.back().push_back(c);
        }
    }
    if (quotation != 0)
        return fail(ErrorCode::InvalidArgument, std::string("a ") + quotation + " is missing in: " + line);
    if (words.empty())
        return fail(ErrorCode::InvalidArgument, "there is no program in it; mpirun -n 4, for example");
    return words;
}

Expected<JobProcess> JobProcess::start(std::vector<std::string> words) {
    JobSpawn spawn;
    ::posix_spawn_file_actions_addopen(&spawn.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&spawn.actions, STDERR_FILENO, STDOUT_FILENO);
    // A child that kept a library's socket would keep a port busy.
    ::posix_spawn_file_actions_addclosefrom_np(&spawn.actions, STDERR_FILENO + 1);
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
    auto environment = jobEnvironment();
    pid_t pid = -1;
    const int error = ::posix_spawnp(&pid, words.front().c_str(), &spawn.actions, &spawn.attributes,
                                     jobPointers(words).data(), jobPointers(environment).data());
    if (error != 0) return fail(ErrorCode::Io, words.front() + " cannot be started: " + systemReason(error));
    return JobProcess(pid);
}

JobProcess::JobProcess(JobProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), status_(std::exchange(other.status_, std::nullopt)) {}

JobProcess::~JobProcess() {
    end();
}

bool JobProcess::hasEnded() {
    int status = 0;
    if (!status_ && pid_ > 0 && ::waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
    return status_ || pid_ <= 0;
}

void JobProcess::ask() const {
    if (!status_ && pid_ > 0) ::kill(-pid_, SIGTERM);
}

void JobProcess::end(std::chrono::milliseconds byItself) {
    const auto endsIn = [this](std::chrono::milliseconds time) {
        const auto giveUp = std::chrono::steady_clock::now() + time;
        while (!hasEnded() && std::chrono::steady_clock::now() < giveUp)
            std::this_thread::sleep_for(looksForEndEvery);
        return hasEnded();
    };
    if (endsIn(byItself)) return;
    ask();
    if (endsIn(endsWithin)) return;
    ::kill(-pid_, SIGKILL);
    int status = 0;
    if (uninterrupted([&] { return ::waitpid(pid_, &status, 0); }) == pid_) status_ = status;
}

std::string JobProcess::howItEnded() const {
    if (!status_) return "it is still there";
    if (WIFEXITED(*status_)) return "it ended with exit code " + std::to_string(WEXITSTATUS(*status_));
    return "it was ended by signal " + std::to_string(WTERMSIG(*status_));
}

}  // namespace scancast
