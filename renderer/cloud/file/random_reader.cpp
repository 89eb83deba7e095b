#include "renderer/cloud/file/random_reader.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "renderer/cloud/import/unique_fd.hpp"

namespace scancast {

namespace {

class FileReader final : public RandomReader {
  public:
    FileReader(UniqueFd fd, std::uint64_t size, std::filesystem::path path)
        : fd_(std::move(fd)), size_(size), path_(std::move(path)) {}

    std::uint64_t size() const override { return size_; }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        return readFullyAt(fd_.get(), offset, into, path_);
    }

  private:
    const UniqueFd fd_;
    const std::uint64_t size_;
    const std::filesystem::path path_;
};

class MemoryReader final : public RandomReader {
  public:
    explicit MemoryReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::uint64_t size() const override { return bytes_.size(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        if (offset >= bytes_.size()) return std::size_t(0);
        const auto there =
            bytes_.subspan(offset, std::min<std::uint64_t>(into.size(), bytes_.size() - offset));
        std::copy(there.begin(), there.end(), into.begin());
        return there.size();
    }

  private:
    const std::span<const std::byte> bytes_;
};

}  // namespace

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
            return fail(ErrorCode::Io, fmt::format("{}, byte {}: cannot be read: {}", name.string(),
                                                   offset + done, systemReason(errno)));
    }
    return done;
}

Expected<std::unique_ptr<RandomReader>> openForReading(const std::filesystem::path& path) {
    // O_NONBLOCK, lest a named pipe keeps us waiting for a writer.
    UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!fd && errno == ENOENT) return fail(ErrorCode::NotFound, path.string() + ": there is no such file");
    struct stat info {};
    if (!fd || ::fstat(fd.get(), &info) != 0)
        return fail(ErrorCode::Io, fmt::format("{}: cannot be opened: {}", path.string(), systemReason(errno)));
    if (!S_ISREG(info.st_mode))
        return fail(ErrorCode::Unsupported,
                    path.string() + ": this is no file (a folder, a pipe or a device); give a cloud file");
    return std::make_unique<FileReader>(std::move(fd), static_cast<std::uint64_t>(info.st_size), path);
}

std::unique_ptr<RandomReader> readerOf(std::span<const std::byte> bytes) {
    return std::make_unique<MemoryReader>(bytes);
}

}  // namespace scancast
