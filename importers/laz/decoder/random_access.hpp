// Bytes at offsets: what the LAZ decoder reads from. Shared by all decoders of a file.
// *Thread safety*: const functions from any number of threads. Place: **file** → decoder → records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "files/input_file.hpp"
#include "protocol/text/grouped.hpp"

namespace scancast::laz {

class RandomAccess {
  public:
    virtual ~RandomAccess() = default;
    virtual std::uint64_t size() const = 0;
    /// Bytes at an offset; fewer only where they end. Errors: Io.
    virtual Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const = 0;
};

class FileAccess final : public RandomAccess {
  public:
    explicit FileAccess(InputFile file) : file_(std::move(file)) {}

    std::uint64_t size() const override { return file_.bytes(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        return file_.readAt(offset, into);
    }

  private:
    InputFile file_;
};

/// Bytes that somebody else owns and keeps.
class MemoryAccess final : public RandomAccess {
  public:
    explicit MemoryAccess(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::uint64_t size() const override { return bytes_.size(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override;

  private:
    std::span<const std::byte> bytes_;
};

/// Fills `into` with the bytes at `offset`. `what` they are is named where the file ends before: "it ends at byte 7, within
/// WHAT". Errors: Truncated, Io.
Expected<void> readAll(const RandomAccess& bytes, std::uint64_t offset, std::span<std::byte> into,
                       const char* what);

}  // namespace scancast::laz
