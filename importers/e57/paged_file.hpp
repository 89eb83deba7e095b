// An E57 file as its sections see it: pages of 1,024 bytes, of which the last four are a checksum of the others. Offsets
// in the file count all bytes ("physical"), lengths of sections leave checksums out ("logical"). Every page is checked
// when it is read. Owned and used by one thread. Pipeline: file → **pages** → sections → points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/import/byte_source.hpp"

namespace scancast::import_e57 {

/// What the file's first 48 bytes say, checked against its size.
struct FileHeader {
    std::uint32_t major = 0, minor = 0;
    std::uint64_t bytes = 0;      ///< of the file; more may follow
    std::uint64_t xmlOffset = 0;  ///< physical
    std::uint64_t xmlBytes = 0;   ///< logical
};

/// Bytes that are not to be had: a range of those that were asked for.
struct LostBytes {
    std::size_t begin = 0, end = 0;
};

class PagedFile {
  public:
    static constexpr std::size_t pageBytes = 1024;
    static constexpr std::size_t contentBytes = 1020;  ///< of a page, without its checksum
    static constexpr std::size_t headerBytes = 48;

    /// `bytes` have a size. Errors, without the file's name: Malformed, Truncated, Unsupported (another version or size of page), Io.
    /// `recover`: its end may be missing, if what describes its scans is there.
    static Expected<PagedFile> open(std::unique_ptr<ByteSource> bytes, bool recover = false);

    bool recovers() const { return recover_; }

    const FileHeader& header() const { return header_; }
    std::uint64_t logicalBytes() const { return header_.bytes / pageBytes * contentBytes; }
    /// Of those, the ones in pages that are there: less in a file that was cut.
    std::uint64_t logicalBytesThere() const { return pagesThere() * contentBytes; }
    /// Bytes behind the end that the header gives.
    std::uint64_t trailingBytes() const { return size_ > header_.bytes ? size_ - header_.bytes : 0; }

    /// Of a physical offset. Error: Malformed, when it lies outside the file or in a checksum; `what` begins the sentence.
    Expected<std::uint64_t> logicalOffset(std::uint64_t physical, std::string_view what) const;
    /// For messages.
    static std::uint64_t physicalOffset(std::uint64_t logical) {
        return logical / contentBytes * pageBytes + logical % contentBytes;
    }

    /// Fills `into` from a logical offset. Errors: Malformed for a wrong checksum, with its page's byte; Truncated beyond
    /// the end; Io.
    Expected<void> read(std::uint64_t logical, std::span<std::byte> into) {
        return readPages(logical, into, nullptr);
    }
    /// The same; but of a file that is to be recovered, what is in pages that are damaged or not there becomes 0, and `lost`, which
    /// is emptied first, gets where that is, in order.
    Expected<void> readSound(std::uint64_t logical, std::span<std::byte> into, std::vector<LostBytes>& lost) {
        lost.clear();
        return readPages(logical, into, recover_ ? &lost : nullptr);
    }

  private:
    PagedFile(std::unique_ptr<ByteSource> bytes, bool recover)
        : bytes_(std::move(bytes)), size_(bytes_->size().value_or(0)), recover_(recover) {}
    Expected<void> readHeader();
    Expected<void> loadPages(std::uint64_t page);
    Expected<void> readPages(std::uint64_t logical, std::span<std::byte> into, std::vector<LostBytes>* lost);
    std::uint64_t pagesThere() const { return std::min(header_.bytes, size_) / pageBytes; }
    bool isSound(std::uint64_t page) const { return sound_[page - first_]; }

    std::unique_ptr<ByteSource> bytes_;
    std::uint64_t size_;
    bool recover_;
    FileHeader header_;
    std::vector<std::byte> pages_;          ///< as they are in the file
    std::vector<bool> sound_;               ///< by their checksums
    std::uint64_t first_ = 0, loaded_ = 0;  ///< which
};

}  // namespace scancast::import_e57
