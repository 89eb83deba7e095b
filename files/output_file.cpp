#include "files/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "files/system_error.hpp"

namespace scancast {
namespace {

constexpr std::size_t bufferBytes = std::size_t(1) << 20;

}  // namespace

Expected<OutputFile> OutputFile::create(const std::string& path) {
    OutputFile out;
    out.path_ = path;
    out.buffer_.reserve(bufferBytes);
    if (path == "-") {
        out.path_ = "standard output";
        out.file_ = STDOUT_FILENO;
        return out;
    }
    struct stat status {};
    const bool exists = stat(path.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        errno = EISDIR;
        return out.failure("write");
    }
    const bool inPlace = exists && !S_ISREG(status.st_mode);
    if (!inPlace) out.temporary_ = UnfinishedName(path + ".partial-" + std::to_string(getpid()));
    // Nobody else's link decides where the temporary file is.
    const int flags = O_WRONLY | O_CLOEXEC | (inPlace ? 0 : O_CREAT | O_TRUNC | O_NOFOLLOW);
    out.owned_ = UniqueFd(open((inPlace ? path : out.temporary_.name()).c_str(), flags, 0666));
    if (!out.owned_) {
        out.temporary_.forget();
        return out.failure("create");
    }
    out.file_ = out.owned_.get();
    out.seekable_ = !inPlace;
    return out;
}

tl::unexpected<Error> OutputFile::failure(const char* what) const {
    const int reason = errno;
    const std::string start = std::string("Cannot ") + what + " " + path_ + ": ";
    if (isFull(reason))
        return fail(ErrorCode::ResourceLimit,
                    start + systemReason(reason) + "; " + wayOutOfFull(reason) + ".");
    return fail(ErrorCode::Io,
                start + (reason == EPIPE ? "its reader went away" : systemReason(reason)) + ".");
}

Expected<void> OutputFile::writeAll(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t done = ::write(file_, bytes.data(), bytes.size());
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return failure("write");
        bytes = bytes.subspan(std::size_t(done));
    }
    return {};
}

Expected<void> OutputFile::flush() {
    auto done = writeAll(buffer_);
    buffer_.clear();
    return done;
}

Expected<void> OutputFile::write(std::span<const std::byte> bytes) {
    written_ += bytes.size();
    if (buffer_.size() + bytes.size() > bufferBytes)
        if (auto ok = flush(); !ok) return ok;
    if (bytes.size() >= bufferBytes) return writeAll(bytes);
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    return {};
}

Expected<void> OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (auto ok = flush(); !ok) return ok;
    while (!bytes.empty()) {
        const ssize_t done = pwrite(file_, bytes.data(), bytes.size(), off_t(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return failure("write");
        offset += std::uint64_t(done);
        bytes = bytes.subspan(std::size_t(done));
    }
    return {};
}

Expected<void> OutputFile::finish() {
    if (auto ok = flush(); !ok) return ok;
    if (owned_ && close(owned_.release()) != 0) return failure("write");
    if (temporary_ && temporary_.become(path_) != 0) return failure("create");
    return {};
}

Expected<void> writeWholeFile(const std::string& path, std::span<const std::byte> bytes) {
    auto file = OutputFile::create(path);
    if (!file) return passOn(std::move(file));
    if (auto ok = file->write(bytes); !ok) return ok;
    return file->finish();
}

}  // namespace scancast
