#include "files/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

constexpr std::size_t bufferBytes = std::size_t(1) << 20;

}  // namespace

Expected<OutputFile> OutputFile::create(const std::string& path, Readers readers) {
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
    if (inPlace) {
        out.owned_.reset(uninterrupted([&] { return open(path.c_str(), O_WRONLY | O_CLOEXEC); }));
        if (!out.owned_) return out.failure("create");
    } else {
        auto made = makeUnfinished(path, readers);
        if (!made)
            return fail(
                made.error().code == ErrorCode::ResourceLimit ? ErrorCode::ResourceLimit : ErrorCode::Io,
                "Cannot create " + made.error().message + ".");
        out.owned_ = std::move(made->fd);
        out.temporary_ = std::move(made->name);
    }
    out.file_ = out.owned_.get();
    out.seekable_ = !inPlace;
    return out;
}

OutputFile OutputFile::to(Take take) {
    OutputFile out;
    out.path_ = "the reader";
    out.buffer_.reserve(bufferBytes);
    out.take_ = std::move(take);
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
    if (take_) return bytes.empty() ? Expected<void>() : take_(bytes);
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
    // While it is locked: nobody sweeps it on its way to its name.
    if (temporary_) {
        if (const int refused = temporary_.become(path_)) {
            errno = refused;
            return failure("create");
        }
    }
    if (owned_ && close(owned_.release()) != 0) return failure("write");
    return {};
}

Expected<void> writeWholeFile(const std::string& path, std::span<const std::byte> bytes, Readers readers) {
    auto file = OutputFile::create(path, readers);
    if (!file) return passOn(std::move(file));
    if (auto ok = file->write(bytes); !ok) return ok;
    return file->finish();
}

}  // namespace scancast
