#include "server/catalog/live_bytes.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "files/input_file.hpp"
#include "files/system_error.hpp"

namespace scancast {
namespace {

// How long a stop may go unseen; bytes that come are read at once.
constexpr int stopMilliseconds = 100;
// A frame is megabytes; the usual 64 KiB would have both sides take turns for every few thousand points.
constexpr int livePipeBytes = 1 << 20;

/// Standard input, for good: once it is closed here its writer is told that nobody reads.
UniqueFd takeStandardInput() {
    UniqueFd taken(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3));
    const UniqueFd nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    if (taken && nothing) ::dup2(nothing.get(), STDIN_FILENO);
    return taken;
}

Expected<UniqueFd> openDescriptor(const std::filesystem::path& path) {
    const bool isInput = path == "-";
    if (isInput && ::isatty(STDIN_FILENO))
        return fail(
            ErrorCode::InvalidArgument,
            "Standard input is a terminal; pipe frames into it, for example: scancast generate statue "
            "--points 100k --frames 0 -o - | scancast serve --live statue=-");
    UniqueFd fd = isInput ? takeStandardInput() : UniqueFd(::open(path.c_str(), inputFlags));
    if (!fd) return failedToOpen(isInput ? "standard input" : path, errno);
    return fd;
}

}  // namespace

Expected<std::unique_ptr<LiveBytes>> LiveBytes::open(const std::filesystem::path& path,
                                                     std::stop_token stop) {
    auto fd = openDescriptor(path);
    if (!fd) return passOn(std::move(fd));
    struct stat facts {};
    if (::fstat(fd->get(), &facts) != 0)
        return fail(ErrorCode::Io, path.string() + ": " + systemReason(errno));
    const bool isPipe = S_ISFIFO(facts.st_mode);
    if (!isPipe && !S_ISREG(facts.st_mode) && !S_ISSOCK(facts.st_mode))
        return fail(ErrorCode::Unsupported, path.string() + " is neither a pipe nor a file of frames.");
    if (isPipe) ::fcntl(fd->get(), F_SETPIPE_SZ, livePipeBytes);  // as large as it may be
    return std::unique_ptr<LiveBytes>(new LiveBytes(std::move(*fd), isPipe && path != "-", std::move(stop)));
}

Expected<std::size_t> LiveBytes::read(std::span<std::byte> into) {
    for (;;) {
        if (stop_.stop_requested()) return fail(ErrorCode::Cancelled, "The server is shutting down.");
        pollfd waiting{.fd = fd_.get(), .events = POLLIN, .revents = 0};
        const int ready = ::poll(&waiting, 1, stopMilliseconds);
        if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
        const auto got = ready < 0 ? -1 : ::read(fd_.get(), into.data(), into.size());
        if (got >= 0) return std::size_t(got);
        if (errno != EINTR && errno != EAGAIN)
            return fail(ErrorCode::Io, "it cannot be read: " + systemReason(errno));
    }
}

}  // namespace scancast
