// Bytes at any offset of something with a size: a file, or memory in tests and fuzzers.
// Pipeline: disk → **bytes** → cloud file. *Thread safety*: readAt() from any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "files/input_file.hpp"

namespace scancast {

class RandomReader {
  public:
    virtual ~RandomReader() = default;
    /// As it is now: a cloud file whose facts are changed grows.
    virtual std::uint64_t size() const = 0;
    /// Reads as many bytes as are there; fewer only where the file ends. Errors: Io.
    virtual Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const = 0;
};

std::unique_ptr<RandomReader> readerOf(InputFile file);

/// Bytes that somebody else owns and keeps.
std::unique_ptr<RandomReader> readerOf(std::span<const std::byte> bytes);

}  // namespace scancast
