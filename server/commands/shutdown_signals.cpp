#include "server/commands/shutdown_signals.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>

namespace scancast {
namespace {

std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free);
int pipeEnds[2] = {-1, -1};

void onSignal(int) {
    const int saved = errno;
    received.fetch_add(1);
    // A full pipe is as good a wake-up as one more byte.
    [[maybe_unused]] const auto written = ::write(pipeEnds[1], "", 1);
    errno = saved;
}

void install(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

ShutdownSignals::ShutdownSignals() {
    // Without a pipe (no descriptors left) waiting still works, only it notices a signal at its time-out.
    if (pipe2(pipeEnds, O_CLOEXEC | O_NONBLOCK) != 0) pipeEnds[0] = pipeEnds[1] = -1;
    install(onSignal);
}

ShutdownSignals::~ShutdownSignals() {
    install(SIG_DFL);
    close(pipeEnds[0]);
    close(pipeEnds[1]);
}

int ShutdownSignals::wait(std::chrono::milliseconds patience) {
    pollfd readable{pipeEnds[0], POLLIN, 0};
    if (poll(&readable, 1, int(patience.count())) > 0) {
        char bytes[16];
        [[maybe_unused]] const auto count = read(pipeEnds[0], bytes, sizeof bytes);
    }
    return received.load();
}

}  // namespace scancast
