// Bytes at any offset of something with a size: a file, an object behind a URL (remote/), or memory in tests and
// fuzzers. Pipeline: disk, network → **bytes** → cloud file. *Thread safety*: everything from any number of threads.
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
    /// Reads as many bytes as are there; fewer only where the file ends. Errors: Io; Unavailable where the network
    /// brings nothing at present, and may later.
    virtual Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const = 0;
    /// They will be read soon: where that takes a while, it begins now. Never waits.
    virtual void expect(std::uint64_t, std::uint64_t) const {}
    /// Drops what is kept of these bytes; true = read again, they may be others.
    virtual bool forget(std::uint64_t, std::uint64_t) const { return false; }
    /// Reading waits for others, not for this machine: many reads at once are no slower than one.
    virtual bool isRemote() const { return false; }
    /// At present there is no reaching what it comes from: what is not here yet is Unavailable.
    virtual bool isAway() const { return false; }
};

std::unique_ptr<RandomReader> readerOf(InputFile file);

/// Bytes that somebody else owns and keeps.
std::unique_ptr<RandomReader> readerOf(std::span<const std::byte> bytes);

}  // namespace scancast
