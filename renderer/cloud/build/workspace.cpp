#include "renderer/cloud/build/workspace.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"
#include "files/unique_fd.hpp"

namespace scancast {

namespace {

/// What bytes take, in memory and as places of a file of which each can become a hole.
std::uint64_t wholePages(std::uint64_t bytes) {
    constexpr std::uint64_t page = 4096;
    return (bytes + page - 1) / page * page;
}

Error diskError(int number, const std::filesystem::path& folder, const char* what) {
    if (isFull(number))
        return {ErrorCode::ResourceLimit,
                fmt::format("There is no more room in the temporary folder {} ({}); {} with --scratch.",
                            folder.string(), systemReason(number), wayOutOfFull(number)),
                {}};
    return {
        ErrorCode::Io,
        fmt::format("A temporary file in {} cannot be {}: {}.", folder.string(), what, systemReason(number)),
        {}};
}

}  // namespace

/// One unnamed file; places in it are handed out one behind the other and given back as holes.
class Scratch {
  public:
    static Expected<std::unique_ptr<Scratch>> create(const std::filesystem::path& folder) {
        std::string name = (folder / ".scancast-XXXXXX").string();
        const std::size_t stem = name.size() - 6;
        UniqueFd fd(uninterrupted([&] {
            name.replace(stem, 6, "XXXXXX");  // a call that failed may have put other letters there
            return ::mkostemp(name.data(), O_CLOEXEC);
        }));
        if (!fd) return tl::unexpected(diskError(errno, folder, "made"));
        ::unlink(name.c_str());
        return std::unique_ptr<Scratch>(new Scratch(std::move(fd), folder));
    }

    std::uint64_t reserve(std::uint64_t bytes) { return end_.fetch_add(wholePages(bytes)); }

    Expected<void> write(std::uint64_t at, std::span<const std::byte> from) const {
        while (!from.empty()) {
            const auto done = ::pwrite(fd_.get(), from.data(), from.size(), static_cast<off_t>(at));
            if (done < 0 && errno == EINTR) continue;
            if (done <= 0) return tl::unexpected(diskError(done < 0 ? errno : ENOSPC, folder_, "written"));
            from = from.subspan(static_cast<std::size_t>(done));
            at += static_cast<std::uint64_t>(done);
        }
        return {};
    }

    Expected<void> read(std::uint64_t at, std::span<std::byte> into) const {
        while (!into.empty()) {
            const auto done = ::pread(fd_.get(), into.data(), into.size(), static_cast<off_t>(at));
            if (done < 0 && errno == EINTR) continue;
            if (done <= 0) return tl::unexpected(diskError(done < 0 ? errno : EIO, folder_, "read"));
            into = into.subspan(static_cast<std::size_t>(done));
            at += static_cast<std::uint64_t>(done);
        }
        return {};
    }

    /// Best effort: a file system without holes keeps the room until the end.
    void release(std::uint64_t at, std::uint64_t bytes) const {
        (void)::fallocate(fd_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(at),
                          static_cast<off_t>(wholePages(bytes)));
    }

  private:
    Scratch(UniqueFd fd, std::filesystem::path folder) : fd_(std::move(fd)), folder_(std::move(folder)) {}

    UniqueFd fd_;
    std::filesystem::path folder_;
    std::atomic<std::uint64_t> end_{0};
};

void UnmapPages::operator()(std::byte* pages) const {
    ::munmap(pages, bytes);
}

namespace {

/// Empty where the system has no memory left.
Pages mapPages(std::uint64_t bytes) {
    void* pages = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) return {};
    return Pages(static_cast<std::byte*>(pages), UnmapPages{bytes});
}

}  // namespace

Workspace::Workspace(std::uint64_t memory, std::filesystem::path folder)
    : left_(static_cast<std::int64_t>(
          std::min<std::uint64_t>(memory, std::numeric_limits<std::int64_t>::max()))),
      folder_(std::move(folder)) {}

Workspace::~Workspace() = default;

Expected<Scratch*> Workspace::scratch() {
    const std::lock_guard lock(mutex_);
    if (!scratch_) {
        auto made = Scratch::create(folder_);
        if (!made) return passOn(made);
        scratch_ = std::move(*made);
    }
    return scratch_.get();
}

Expected<Workspace::Buffer> Workspace::allocate(std::uint64_t bytes) {
    Buffer buffer;
    if (bytes == 0) return buffer;
    const auto size = static_cast<std::int64_t>(wholePages(bytes));
    if (left_.fetch_sub(size) >= size) buffer.memory_ = mapPages(bytes);
    // What the system has no memory for waits in the file, like what the limit has none for.
    if (!buffer.memory_) {
        left_ += size;
        auto file = scratch();
        if (!file) return passOn(file);
    }
    // From here on it is this workspace's, and gives its room back.
    buffer.home_ = this;
    buffer.bytes_ = bytes;
    if (buffer.memory_) return buffer;
    buffer.place_ = scratch_->reserve(bytes);
    const std::uint64_t now = onDisk_ += bytes;
    for (std::uint64_t most = mostOnDisk_; now > most && !mostOnDisk_.compare_exchange_weak(most, now);) {
    }
    return buffer;
}

Workspace::Buffer::Buffer(Buffer&& other) noexcept {
    *this = std::move(other);
}

Workspace::Buffer& Workspace::Buffer::operator=(Buffer&& other) noexcept {
    if (this == &other) return *this;
    clear();
    home_ = std::exchange(other.home_, nullptr);
    bytes_ = std::exchange(other.bytes_, 0);
    place_ = other.place_;
    memory_ = std::move(other.memory_);
    return *this;
}

Workspace::Buffer::~Buffer() {
    clear();
}

void Workspace::Buffer::clear() {
    if (!home_) return;
    if (memory_) {
        home_->left_ += static_cast<std::int64_t>(wholePages(bytes_));
        memory_.reset();
    } else {
        home_->scratch_->release(place_, bytes_);
        home_->onDisk_ -= bytes_;
    }
    home_ = nullptr;
    bytes_ = 0;
}

Expected<void> Workspace::Buffer::write(std::uint64_t offset, std::span<const std::byte> from) {
    if (from.empty()) return {};
    if (memory_) {
        std::memcpy(memory_.get() + offset, from.data(), from.size());
        return {};
    }
    return home_->scratch_->write(place_ + offset, from);
}

Expected<void> Workspace::Buffer::read(std::uint64_t offset, std::span<std::byte> into) const {
    if (into.empty()) return {};
    if (memory_) {
        std::memcpy(into.data(), memory_.get() + offset, into.size());
        return {};
    }
    return home_->scratch_->read(place_ + offset, into);
}

Expected<std::span<const std::byte>> Workspace::Buffer::view(std::vector<std::byte>& space) const {
    if (memory_ || bytes_ == 0) return std::span<const std::byte>(memory_.get(), bytes_);
    space.resize(bytes_);
    if (auto ok = read(0, space); !ok) return passOn(ok);
    return std::span<const std::byte>(space);
}

}  // namespace scancast
