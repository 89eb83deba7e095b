// Where a reader's bytes come from: a file, a pipe, memory. Readers know nothing else of the outside, so that
// a test or a fuzzer feeds them from memory and standard input needs no reader of its own. Pipeline:
// **bytes** → reader → points. Owned by one reader, used on its thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "files/input_file.hpp"

namespace scancast {

class ByteSource {
  public:
    virtual ~ByteSource() = default;
    /// Next bytes, front to back; may be fewer than asked for. 0 = the end. Errors: Io, and Importer for a
    /// process.
    virtual Expected<std::size_t> read(std::span<std::byte> into) = 0;
    /// Total bytes; nullopt = not known, and then nothing but read() works (standard input, pipes).
    virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
    /// Bytes at an absolute offset, without moving read(). Only where size() is known; fewer at the end.
    virtual Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into);
    /// Moves read() to an absolute offset. Only where size() is known.
    virtual Expected<void> seek(std::uint64_t offset);
};

/// Reads until `into` is full or the source ends.
Expected<std::size_t> readFully(ByteSource& source, std::span<std::byte> into);

/// An open file, pipe or terminal. A regular file has a size, can seek, and has its own place in it, whoever
/// else reads the same open file.
class FileByteSource final : public ByteSource {
  public:
    /// `name` is what messages call it.
    static Expected<std::unique_ptr<FileByteSource>> create(UniqueFd fd, std::string name);

    Expected<std::size_t> read(std::span<std::byte> into) override;
    std::optional<std::uint64_t> size() const override { return size_; }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) override;
    Expected<void> seek(std::uint64_t offset) override;

  private:
    FileByteSource(UniqueFd fd, std::string name, std::optional<std::uint64_t> size)
        : fd_(std::move(fd)), name_(std::move(name)), size_(size) {}

    UniqueFd fd_;
    std::string name_;
    std::optional<std::uint64_t> size_;
    std::uint64_t position_ = 0;
};

/// Bytes in memory that somebody else owns and keeps.
class MemoryByteSource final : public ByteSource {
  public:
    /// `seekable = false` behaves as a pipe does, short reads included.
    explicit MemoryByteSource(std::span<const std::byte> bytes, bool seekable = true)
        : bytes_(bytes), seekable_(seekable) {}

    Expected<std::size_t> read(std::span<std::byte> into) override;
    std::optional<std::uint64_t> size() const override;
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) override;
    Expected<void> seek(std::uint64_t offset) override;

  private:
    std::span<const std::byte> bytes_;
    bool seekable_;
    std::size_t position_ = 0;
};

}  // namespace scancast
