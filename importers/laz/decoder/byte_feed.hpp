// The bytes of one compressed stream, front to back, through a window: a stream may be as long as a file, memory is not.
// Behind its end come zeros, which are counted: how far a decoder may look ahead is for its user to judge.
// Owned and used by one decoder. Place: file → **feed** → arithmetic decoder.
#pragma once

#include <optional>
#include <vector>

#include "importers/laz/decoder/random_access.hpp"

namespace scancast::laz {

class ByteFeed {
  public:
    /// Nothing.
    void close();
    /// The bytes [from, to) of a file, by `window` bytes at a time.
    void open(const RandomAccess& source, std::uint64_t from, std::uint64_t to, std::size_t window);
    /// Bytes in memory that somebody keeps; they stand at `from` of the file.
    void open(std::span<const std::byte> bytes, std::uint64_t from);

    std::uint8_t next() {
        if (at_ != end_) [[likely]]
            return static_cast<std::uint8_t>(*at_++);
        return nextBehindWindow();
    }
    /// Fills `into`; with zeros behind the end.
    void take(std::span<std::byte> into);

    /// Whether there were any bytes to begin with.
    bool isOpen() const { return open_; }
    /// Where in the file the next byte stands, zeros behind the end not counted.
    std::uint64_t position() const { return windowEnd_ - static_cast<std::uint64_t>(end_ - at_); }
    /// Zeros that were handed out.
    std::uint64_t beyond() const { return beyond_; }
    /// What went wrong in reading the file, once.
    const std::optional<Error>& failure() const { return failure_; }

  private:
    std::uint8_t nextBehindWindow();

    const std::byte* at_ = nullptr;
    const std::byte* end_ = nullptr;
    std::uint64_t windowEnd_ = 0;  // of the file
    std::uint64_t limit_ = 0;      // of the file
    std::uint64_t beyond_ = 0;
    const RandomAccess* source_ = nullptr;
    std::vector<std::byte> window_;
    bool open_ = false;
    std::optional<Error> failure_;
};

}  // namespace scancast::laz
