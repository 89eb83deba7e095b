#include "server/terminal/interruption.hpp"

#include <unistd.h>

#include <chrono>

namespace scancast {

Interruption::Interruption() : watcher_([this](const std::stop_token& done) { watch(done); }) {}

void Interruption::watch(const std::stop_token& done) {
    while (!done.stop_requested()) {
        const int signals = signals_.wait(std::chrono::milliseconds(100));
        if (signals > 0) stop_.request_stop();
        if (signals > 1) ::_exit(130);
    }
}

}  // namespace scancast
