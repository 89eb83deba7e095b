// Runs a command and fails where it took more processor time than it may, children included: slow tests are noticed
// when they become slow, not when everything takes an hour.
//
//   within_budget SECONDS COMMAND [ARGUMENT...]
//
// Processor time, since other programs disturb it less than time on the clock; budgets are several times what is
// measured on an idle machine, so that a slow one stays within them. The command's own exit status comes first.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

constexpr int overBudget = 1, cannotStart = 127, usage = 2;

double secondsOf(const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

}  // namespace

int main(int argc, char** argv) {
    char* end = nullptr;
    const double budget = argc > 2 ? std::strtod(argv[1], &end) : 0;
    if (argc < 3 || *end != '\0' || !(budget > 0)) {
        std::fprintf(stderr, "Usage: within_budget SECONDS COMMAND [ARGUMENT...]\n");
        return usage;
    }
    const pid_t child = fork();
    if (child == 0) {
        execvp(argv[2], argv + 2);
        std::fprintf(stderr, "within_budget: %s cannot be started: %s\n", argv[2], std::strerror(errno));
        _exit(cannotStart);
    }
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    if (child < 0) {
        std::perror("within_budget: fork");
        return cannotStart;
    }
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    const double seconds = secondsOf(used.ru_utime) + secondsOf(used.ru_stime);
    std::fflush(stdout);
    std::printf("processor time: %.2f s, budget %g s\n", seconds, budget);
    std::fflush(stdout);
    if (WIFSIGNALED(status)) {
        std::printf("%s ended by signal %d (%s)\n", argv[2], WTERMSIG(status), strsignal(WTERMSIG(status)));
        std::fflush(stdout);
        signal(WTERMSIG(status), SIG_DFL);
        raise(WTERMSIG(status));  // seen by ctest as what it is
        return cannotStart;
    }
    if (const int code = WEXITSTATUS(status); code != 0) return code;
    if (seconds <= budget) return 0;
    std::printf("OVER BUDGET: make it faster, or say in its CMakeLists.txt why it may take longer (BUDGET).\n");
    return overBudget;
}
