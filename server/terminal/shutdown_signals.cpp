#include "server/terminal/shutdown_signals.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>

namespace scancast {
namespace {

std::atomic<int> ends{0}, reloadsSoFar{0}, othersSoFar{0};
static_assert(std::atomic<int>::is_always_lock_free);
int pipeEnds[2] = {-1, -1};

void count(std::atomic<int>& signals) {
    const int saved = errno;
    signals.fetch_add(1);
    // A full pipe is as good a wake-up as one more byte.
    [[maybe_unused]] const auto written = ::write(pipeEnds[1], "", 1);
    errno = saved;
}

void onEnd(int) {
    count(ends);
}

void onReload(int) {
    count(reloadsSoFar);
}

void onOther(int) {
    count(othersSoFar);
}

constexpr std::array handled{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2};
std::array<struct sigaction, handled.size()> before;

void handle(int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

bool isIgnored(int signal) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    return action.sa_handler == SIG_IGN;
}

}  // namespace

ShutdownSignals::ShutdownSignals(Hangup hangup) {
    // Without a pipe (no descriptors left) waiting still works, only it notices a signal at its time-out.
    if (pipe2(pipeEnds, O_CLOEXEC | O_NONBLOCK) != 0) pipeEnds[0] = pipeEnds[1] = -1;
    for (std::size_t i = 0; i < handled.size(); ++i) sigaction(handled[i], nullptr, &before[i]);
    for (const int signal : {SIGINT, SIGTERM}) handle(signal, onEnd);
    if (hangup == Hangup::Reloads) {
        handle(SIGHUP, onReload);
        for (const int signal : {SIGUSR1, SIGUSR2}) handle(signal, onOther);
    } else if (!isIgnored(SIGHUP)) {
        handle(SIGHUP, onEnd);
    }
}

ShutdownSignals::~ShutdownSignals() {
    for (std::size_t i = 0; i < handled.size(); ++i) sigaction(handled[i], &before[i], nullptr);
    close(pipeEnds[0]);
    close(pipeEnds[1]);
}

int ShutdownSignals::wait(std::chrono::milliseconds patience) {
    pollfd readable{pipeEnds[0], POLLIN, 0};
    if (poll(&readable, 1, int(patience.count())) > 0) {
        char bytes[16];
        [[maybe_unused]] const auto got = read(pipeEnds[0], bytes, sizeof bytes);
    }
    return ends.load();
}

int ShutdownSignals::reloads() const {
    return reloadsSoFar.load();
}

int ShutdownSignals::others() const {
    return othersSoFar.load();
}

}  // namespace scancast
