// Lines of text out of a bounded buffer: what the readers of XYZ, CSV, PTS and PTX are made of.
// Pipeline: bytes → **lines** → rows → points. Owned and used by one reader, on its thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/import/byte_source.hpp"

namespace scancast {

// How much of a text is looked at to understand its columns: lines of its beginning, then places all over it.
inline constexpr std::size_t lookedAtLines = 500;
inline constexpr std::size_t lookedAtPlaces = 16;
inline constexpr std::size_t lookedAtBytes = 4096;  ///< of each place

/// Ends of lines are \n, \r\n, or \r alone where the text has no \n at all. A byte order mark is passed over.
class TextLines {
  public:
    /// No line of a scan is longer; what has longer ones is not a scan.
    static constexpr std::size_t longestLine = 65536;
    /// How much of the beginning can be looked at before the first line is taken.
    static constexpr std::size_t peekBytes = std::size_t(256) << 10;

    TextLines(std::unique_ptr<ByteSource> bytes, std::string name);

    /// Fills the buffer for start(). To be called once, before all others. Errors: Io, Unsupported (UTF-16),
    /// Malformed.
    Expected<void> open();
    /// The beginning of the text, whole lines only, as far as peekBytes go.
    std::string_view start() const;
    /// Lines from other places of a file, for guesses about the whole of it; none from a pipe. Whole lines
    /// only, at most `bytes` from each of `places` evenly spread ones.
    Expected<std::vector<std::string>> samples(std::size_t places, std::size_t bytes);
    char lineEnd() const { return lineEnd_; }

    /// The next line without its end, valid until the next call; false at the end of the text. Errors: Io,
    /// Malformed for a line that is too long.
    Expected<bool> next(std::string_view& line) {
        const auto* from = buffer_.data() + at_;
        const auto* end = static_cast<const char*>(std::memchr(from, lineEnd_, filled_ - at_));
        if (end == nullptr || end - from > static_cast<std::ptrdiff_t>(longestLine))
            return nextAcrossBuffers(line);
        take(from, static_cast<std::size_t>(end - from), 1, line);
        return true;
    }

    /// The line taken last has no end: it is the text's last, and of a text that was cut it may be part of a line.
    bool lineIsOpen() const { return open_; }
    std::uint64_t lineNumber() const { return lineNumber_; }  ///< of the line taken last; the first is 1
    std::uint64_t bytesTaken() const { return taken_; }
    std::uint64_t bytesTotal() const { return bytes_->size().value_or(0); }
    /// "FILE, line 12: " for messages about the line taken last.
    std::string place() const;

  private:
    Expected<bool> nextAcrossBuffers(std::string_view& line);
    Expected<void> refill();
    void take(const char* from, std::size_t length, std::size_t endBytes, std::string_view& line) {
        at_ += length + endBytes;
        taken_ += length + endBytes;
        open_ = endBytes == 0;
        ++lineNumber_;
        if (length > 0 && from[length - 1] == '\r') --length;
        line = {from, length};
    }

    std::unique_ptr<ByteSource> bytes_;
    std::string name_;
    std::vector<char> buffer_;
    std::size_t at_ = 0;      ///< first byte of the buffer that is not taken yet
    std::size_t filled_ = 0;  ///< bytes in the buffer
    bool ended_ = false;      ///< the source has no more
    bool open_ = false;
    char lineEnd_ = '\n';
    std::uint64_t taken_ = 0;
    std::uint64_t lineNumber_ = 0;
};

}  // namespace scancast
