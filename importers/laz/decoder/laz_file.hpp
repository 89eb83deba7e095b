// A LAZ file - LAS whose records LASzip has compressed -, taken apart: its head, its extended records, where its chunks are.
// Every length and number in it is checked before it is believed; what its records mean is nothing that this room knows.
// Written after "LAZ Specification 1.4" (rapidlasso) and ASPRS LAS 1.4 R15. *Thread safety*: const functions from any
// number of threads. Pipeline: bytes → **LAZ file** → decoders, one a thread → records as LAS has them.
#pragma once

#include <memory>
#include <vector>

#include "importers/laz/decoder/chunk_table.hpp"
#include "importers/laz/decoder/random_access.hpp"

namespace scancast::laz {

class LazFile {
  public:
    /// The messages of errors are sentences about "it", the file, without its name. Errors: Malformed, Truncated, Empty
    /// (no points), Unsupported, ResourceLimit, Io. LAS that is not compressed is fine, too: chunks are then runs of records.
    /// `mayBeCut`: the end of the file may be missing, and with it the chunk table; then keepWhole() has to follow.
    static Expected<LazFile> open(std::shared_ptr<const RandomAccess> bytes, bool mayBeCut = false);

    /// One chunk, of `points` points, that somebody else took out of a file whose records are like that: `bytes` hold it and nothing else.
    /// `laszip`: the content of that file's record "laszip encoded". Errors: Malformed, Unsupported, ResourceLimit.
    static Expected<LazFile> ofChunk(std::shared_ptr<const RandomAccess> bytes, int pointFormat,
                                     std::uint32_t recordBytes, std::uint64_t points,
                                     std::span<const std::byte> laszip);

    /// Decodes points whose chunks nobody wrote down, and leaves away those whose bytes are not there. Returns how many of all points are left,
    /// at least one. Errors: Truncated, Io.
    Expected<std::uint64_t> keepWhole();

    const LasShape& shape() const { return shape_; }
    /// Header and variable length records, as they would stand before the records of an uncompressed file; whole records left
    /// away behind 16 MiB.
    std::span<const std::byte> head() const { return head_; }
    /// Those of LAS 1.4, one behind the other, without any whose content is longer than 65,536 bytes. A damaged one ends them.
    std::span<const std::byte> extendedRecords() const { return extended_; }
    /// At least one, in the order of the file; together all points.
    const std::vector<Chunk>& chunks() const { return chunks_; }
    /// How the records are compressed; no items: they are not.
    const LaszipRecord& compression() const { return laszip_; }
    const RandomAccess& bytes() const { return *bytes_; }

  private:
    LazFile() = default;

    std::shared_ptr<const RandomAccess> bytes_;
    LasShape shape_;
    LaszipRecord laszip_;
    std::vector<std::byte> head_, extended_;
    std::vector<Chunk> chunks_;
};

/// What is wanted of records.
enum class Wanted {
    Everything,
    /// The colours; fields that are compressed apart from them stay as they are in the chunk's first record. Faster.
    Colors,
};

/// Decodes one chunk after the other, in any order and in pieces of any size. Owned and used by one thread; the file has to
/// outlive it. Its memory is bounded, about 2 MiB, whatever a chunk holds: that is read piece by piece, too.
class LazDecoder {
  public:
    explicit LazDecoder(const LazFile& file, Wanted wanted = Wanted::Everything);
    ~LazDecoder();
    LazDecoder(LazDecoder&&) noexcept;
    LazDecoder& operator=(LazDecoder&&) = delete;

    /// Goes to the beginning of a chunk of the file. Errors: Malformed, Truncated, Io.
    Expected<void> start(const Chunk& chunk);
    /// Points that the chunk still has.
    std::uint64_t left() const;
    /// Whether it has looked for bytes behind the end of a stream: what it read last may be made up.
    bool ranDry() const;
    /// The next records, one behind the other: `records` has room for a whole number of them, not more than are left.
    /// Errors: Malformed, Truncated, naming the byte and the point; Io.
    Expected<void> read(std::span<std::byte> records);

  private:
    class Work;
    class PlainWork;
    class PointwiseWork;
    class LayeredWork;

    std::unique_ptr<Work> work_;
};

/// All records of a chunk: `records` has room for exactly them.
Expected<void> decodeChunk(const LazFile& file, const Chunk& chunk, std::span<std::byte> records);

}  // namespace scancast::laz
