#include "renderer/cloud/import/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "files/system_error.hpp"

namespace scancast {

namespace {

// The kernel transfers at most 2 GiB at once; one bound for all keeps the arithmetic simple.
constexpr std::size_t largestTransfer = std::size_t(1) << 30;

}  // namespace

Expected<std::size_t> ByteSource::readAt(std::uint64_t, std::span<std::byte>) {
    return fail(ErrorCode::Internal, "this byte source cannot read at an offset");
}

Expected<void> ByteSource::seek(std::uint64_t) {
    return fail(ErrorCode::Internal, "this byte source cannot seek");
}

Expected<std::size_t> readFully(ByteSource& source, std::span<std::byte> into) {
    std::size_t done = 0;
    while (done < into.size()) {
        const auto got = source.read(into.subspan(done));
        if (!got) return passOn(got);
        if (*got == 0) break;
        done += *got;
    }
    return done;
}

Expected<std::unique_ptr<FileByteSource>> FileByteSource::create(UniqueFd fd, std::string name) {
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return fail(ErrorCode::Io, name + ": " + systemReason(errno));
    std::optional<std::uint64_t> size;
    if (S_ISREG(info.st_mode)) {
        size = static_cast<std::uint64_t>(info.st_size);
#ifdef POSIX_FADV_SEQUENTIAL
        ::posix_fadvise(fd.get(), 0, 0, POSIX_FADV_SEQUENTIAL);
#endif
    }
    return std::unique_ptr<FileByteSource>(new FileByteSource(std::move(fd), std::move(name), size));
}

Expected<std::size_t> FileByteSource::read(std::span<std::byte> into) {
    const std::size_t most = std::min(into.size(), largestTransfer);
    for (;;) {
        const auto got = size_ ? ::pread(fd_.get(), into.data(), most, static_cast<off_t>(position_))
                               : ::read(fd_.get(), into.data(), most);
        if (got >= 0) {
            position_ += static_cast<std::uint64_t>(got);
            return static_cast<std::size_t>(got);
        }
        if (errno != EINTR) return fail(ErrorCode::Io, name_ + ": " + systemReason(errno));
    }
}

Expected<std::size_t> FileByteSource::readAt(std::uint64_t offset, std::span<std::byte> into) {
    return readFullyAt(fd_.get(), offset, into, name_);
}

Expected<void> FileByteSource::seek(std::uint64_t offset) {
    position_ = offset;
    return {};
}

Expected<std::size_t> MemoryByteSource::read(std::span<std::byte> into) {
    // A pipe hands out what it has: an odd, small number, so that readers meet every split.
    constexpr std::size_t pipeBytes = 4093;
    auto count = std::min(into.size(), bytes_.size() - position_);
    if (!seekable_) count = std::min(count, pipeBytes);
    if (count > 0) std::memcpy(into.data(), bytes_.data() + position_, count);
    position_ += count;
    return count;
}

std::optional<std::uint64_t> MemoryByteSource::size() const {
    if (!seekable_) return std::nullopt;
    return bytes_.size();
}

Expected<std::size_t> MemoryByteSource::readAt(std::uint64_t offset, std::span<std::byte> into) {
    if (offset >= bytes_.size()) return std::size_t(0);
    const auto count = std::min<std::size_t>(into.size(), bytes_.size() - offset);
    std::memcpy(into.data(), bytes_.data() + offset, count);
    return count;
}

Expected<void> MemoryByteSource::seek(std::uint64_t offset) {
    position_ = std::min<std::uint64_t>(offset, bytes_.size());
    return {};
}

}  // namespace scancast
