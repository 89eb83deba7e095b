#include "renderer/cloud/build/workspace.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace scancast {

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

Expected<ScratchFile*> Workspace::scratch() {
    const std::lock_guard lock(mutex_);
    if (!scratch_) {
        auto made = ScratchFile::create(folder_, "--scratch");
        if (!made) return passOn(made);
        scratch_ = std::move(*made);
    }
    return scratch_.get();
}

Expected<Workspace::Buffer> Workspace::allocate(std::uint64_t bytes) {
    Buffer buffer;
    if (bytes == 0) return buffer;
    const auto size = static_cast<std::int64_t>(ScratchFile::wholePages(bytes));
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
        home_->left_ += static_cast<std::int64_t>(ScratchFile::wholePages(bytes_));
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
