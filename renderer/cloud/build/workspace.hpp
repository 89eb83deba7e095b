// Room for what a build sets aside: in memory while there is some left, then in an unnamed temporary file,
// which vanishes with the process, whatever ends it. Used by staging, chunks and inner samples.
//
// *Thread safety*: a Workspace and its Buffers may be used from any thread; writes to one buffer must not
// overlap.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "files/scratch_file.hpp"
#include "protocol/error.hpp"

namespace scancast {

/// Memory straight from the system, and straight back: what an allocator kept of it would count twice.
struct UnmapPages {
    std::uint64_t bytes = 0;
    void operator()(std::byte* pages) const;
};
using Pages = std::unique_ptr<std::byte, UnmapPages>;

class Workspace {
  public:
    static constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

    /// `memory`: bytes that buffers may hold in memory; the temporary file is made in `folder` when they need
    /// more.
    Workspace(std::uint64_t memory, std::filesystem::path folder);
    ~Workspace();
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;

    class Buffer {
      public:
        Buffer() = default;
        Buffer(Buffer&& other) noexcept;
        Buffer& operator=(Buffer&& other) noexcept;
        ~Buffer();

        std::uint64_t bytes() const { return bytes_; }
        /// Its bytes, where they are in memory; else null.
        std::byte* memory() const { return memory_.get(); }
        Expected<void> write(std::uint64_t offset, std::span<const std::byte> from);
        Expected<void> read(std::uint64_t offset, std::span<std::byte> into) const;
        /// All bytes: those in memory, or read into `space`.
        Expected<std::span<const std::byte>> view(std::vector<std::byte>& space) const;
        /// Gives the room back.
        void clear();

      private:
        friend class Workspace;
        Workspace* home_ = nullptr;
        std::uint64_t bytes_ = 0, place_ = 0;
        Pages memory_;
    };

    /// Errors: Io, ResourceLimit for a full disk (on writing) or no folder to write to. What the
    /// system has no memory for goes to the file, too.
    Expected<Buffer> allocate(std::uint64_t bytes);
    /// For memory outside of buffers that stays until the end: as much less is left for those to come.
    void occupy(std::uint64_t bytes) { left_ -= static_cast<std::int64_t>(bytes); }
    /// Most bytes that the temporary file held at once.
    std::uint64_t mostOnDisk() const { return mostOnDisk_; }

  private:
    Expected<ScratchFile*> scratch();

    std::atomic<std::int64_t> left_;
    const std::filesystem::path folder_;
    std::mutex mutex_;
    std::unique_ptr<ScratchFile> scratch_;
    std::atomic<std::uint64_t> onDisk_{0}, mostOnDisk_{0};
};

}  // namespace scancast
