#include "files/raw_writes.hpp"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "files/uninterrupted.hpp"

namespace scancast {

int writeFullyAt(int fd, std::uint64_t offset, std::span<const std::byte> bytes) {
    constexpr std::size_t largestTransfer = std::size_t(1) << 30;
    while (!bytes.empty()) {
        const auto put =
            ::pwrite(fd, bytes.data(), std::min(bytes.size(), largestTransfer), static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return put < 0 ? errno : ENOSPC;
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return 0;
}

int syncFile(int fd) {
    return uninterrupted([&] { return ::fsync(fd); }) != 0 ? errno : 0;
}

int lockNow(int fd) {
    return uninterrupted([&] { return ::flock(fd, LOCK_EX | LOCK_NB); }) == 0 ? 0 : errno;
}

bool isStillNamed(int fd, const std::filesystem::path& name) {
    struct stat opened {
    }, named{};
    return ::fstat(fd, &opened) == 0 && ::stat(name.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

}  // namespace scancast
