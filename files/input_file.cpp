#include "files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {

namespace {

const char* kindOf(mode_t mode) {
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

FileIdentity identityOf(const struct stat& info) {
    constexpr std::int64_t nanoseconds = 1'000'000'000;
    return {info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size),
            info.st_mtim.tv_sec * nanoseconds + info.st_mtim.tv_nsec};
}

}  // namespace

const int inputFlags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

tl::unexpected<Error> failedToOpen(const std::filesystem::path& name, int error) {
    if (error == ENOENT || error == ENOTDIR)
        return fail(ErrorCode::NotFound, name.string() + ": there is no such file");
    return fail(ErrorCode::Io, name.string() + " cannot be opened: " + systemReason(error));
}

Expected<InputFile> InputFile::open(const std::filesystem::path& path) {
    UniqueFd fd(uninterrupted([&] { return ::open(path.c_str(), inputFlags); }));
    if (!fd) return failedToOpen(path, errno);
    return adopt(std::move(fd), path);
}

Expected<InputFile> InputFile::adopt(UniqueFd fd, std::filesystem::path name) {
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return failedToOpen(name, errno);
    if (!S_ISREG(info.st_mode))
        return fail(ErrorCode::Unsupported, name.string() + " is " + kindOf(info.st_mode) + ", not a file");
    InputFile file(std::move(fd), std::move(name));
    file.identity_ = identityOf(info);
    file.permissions_ = info.st_mode & ~mode_t(S_IFMT);
    return file;
}

Expected<InputFile> InputFile::share() const {
    constexpr int behindStandardStreams = 3;
    UniqueFd fd(::fcntl(fd_.get(), F_DUPFD_CLOEXEC, behindStandardStreams));
    if (!fd) return failedToOpen(name_, errno);
    InputFile file(std::move(fd), name_);
    file.identity_ = identity_;
    file.permissions_ = permissions_;
    return file;
}

Expected<std::size_t> InputFile::readAt(std::uint64_t offset, std::span<std::byte> into) const {
    return readFullyAt(fd_.get(), offset, into, name_);
}

Expected<std::string> InputFile::text(std::size_t most) const {
    std::string text;
    // One byte more than it had, and more where that is there: it may have grown, and some file systems tell
    // no sizes.
    std::size_t wanted = std::min<std::uint64_t>(bytes(), most) + 1;
    for (std::size_t done = 0;; wanted = std::min(2 * wanted, most + 1)) {
        text.resize(wanted);
        const auto got = readAt(done, std::as_writable_bytes(std::span(text)).subspan(done));
        if (!got) return passOn(got);
        done += *got;
        if (done > most)
            return fail(ErrorCode::ResourceLimit,
                        name_.string() + " is longer than " + std::to_string(most) + " bytes");
        if (done < wanted) {
            text.resize(done);
            return text;
        }
    }
}

Expected<std::string> readTextFile(const std::filesystem::path& path, std::size_t most) {
    const auto file = InputFile::open(path);
    if (!file) return passOn(file);
    return file->text(most);
}

Expected<std::size_t> readFullyAt(int fd, std::uint64_t offset, std::span<std::byte> into,
                                  const std::filesystem::path& name) {
    constexpr std::size_t largestTransfer = std::size_t(1) << 30;  // the kernel's is 2 GiB
    std::size_t done = 0;
    while (done < into.size()) {
        const auto got = ::pread(fd, into.data() + done, std::min(into.size() - done, largestTransfer),
                                 static_cast<off_t>(offset + done));
        if (got == 0) break;
        if (got > 0)
            done += static_cast<std::size_t>(got);
        else if (errno != EINTR)
            return fail(ErrorCode::Io, name.string() + ", byte " + std::to_string(offset + done) +
                                           ": cannot be read: " + systemReason(errno));
    }
    return done;
}

}  // namespace scancast
