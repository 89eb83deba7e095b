#include "files/program_start.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>

namespace scancast {

void startProgram() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
        // The lowest free number is given: where this one is free, it is this one.
        if (::fcntl(fd, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
}

}  // namespace scancast
