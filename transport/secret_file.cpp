#include "transport/secret_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "protocol/bearer.hpp"

namespace scancast {
namespace {

// Closes itself; the checks are made on what was opened, so that nobody can swap the file in between.
class File {
  public:
    explicit File(const std::filesystem::path& path)
        : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
    ~File() {
        if (fd_ >= 0) ::close(fd_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int fd() const { return fd_; }

  private:
    int fd_;
};

Expected<void> check(const File& file, const std::filesystem::path& path) {
    if (file.fd() < 0) {
        return fail(errno == ENOENT ? ErrorCode::NotFound : ErrorCode::Io,
                    path.string() + " cannot be read: " + std::strerror(errno) + ".");
    }
    struct stat status {};
    if (::fstat(file.fd(), &status) != 0)
        return fail(ErrorCode::Io, path.string() + " cannot be read: " + std::strerror(errno) + ".");
    if (!S_ISREG(status.st_mode)) return fail(ErrorCode::InvalidArgument, path.string() + " is no file.");
    if ((status.st_mode & (S_IWGRP | S_IRWXO)) != 0) {
        return fail(ErrorCode::InvalidArgument,
                    path.string() +
                        " is a secret that others can read or change; make it yours alone: chmod 600 " +
                        path.string());
    }
    return {};
}

}  // namespace

Expected<void> checkSecretFile(const std::filesystem::path& path) {
    return check(File(path), path);
}

Expected<std::string> readTokenFile(const std::filesystem::path& path) {
    const File file(path);
    if (auto sound = check(file, path); !sound) return tl::unexpected(std::move(sound.error()));
    // Longer than any token, with room for white space; what is longer still fails as a token.
    std::array<char, 2 * longestToken> bytes{};
    std::size_t size = 0;
    while (size < bytes.size()) {
        const auto count = ::read(file.fd(), bytes.data() + size, bytes.size() - size);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0)
            return fail(ErrorCode::Io, path.string() + " cannot be read: " + std::strerror(errno) + ".");
        if (count == 0) break;
        size += std::size_t(count);
    }
    auto token = parseToken({bytes.data(), size});
    if (!token) token.error().message = path.string() + ": " + token.error().message + ".";
    return token;
}

}  // namespace scancast
