// Both indices of a cloud file as they are stored since version 3, and back: exact for any records, and a quarter as
// large (CLOUD_FILE.md, "Packed indices"). Who opens a cloud far away waits for all of its index before the first picture.
// Pipeline: nodes, places → records → **residuals → packed index** → cloud file, and back.
//
// A residual is a record XOR what is expected of it, by those before it and by its own fields; most of its bytes are 0
// in all records. Residuals are packed in chunks by byte planes, as blocks are - but for their checksums, which stand
// as they are: so no stored byte stands for more than a few decoded ones, whatever a file claims.
//
// *Thread safety*: pure functions; objects are their owner's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/file/file_layout.hpp"

namespace scancast {

/// What an index is made of: records of so many bytes, in each a checksum.
struct PackedLayout {
    std::size_t recordBytes, checksumOffset;
    /// More than any chunk takes.
    std::size_t longestChunk() const;
};
inline constexpr PackedLayout packedNodes{nodeRecordBytes, offsetIn(nodeRecordFields, "samplesChecksum")};
inline constexpr PackedLayout packedPlaces{planeRecordBytes, offsetIn(planeRecordFields, "checksum")};

/// What is expected of nodes' records, front to back. XOR makes residuals of records, and records of residuals.
class ExpectedNodes {
  public:
    /// `before`: all nodes in front of this one. Encoding: `known` is the record, `record` a copy. Decoding: both are the
    /// residual, which becomes the record.
    void apply(std::span<const StoredNode> before, NodeRecord known,
               std::span<std::byte, nodeRecordBytes> record);

  private:
    std::uint32_t nextChild_ = 1;
};

/// The same of the records of planes, `planes` of each of the nodes.
class ExpectedPlaces {
  public:
    ExpectedPlaces(std::span<const StoredNode> nodes, std::size_t planes) : nodes_(nodes), planes_(planes) {}
    void apply(PlaneRecord known, std::span<std::byte, planeRecordBytes> record);

  private:
    const std::span<const StoredNode> nodes_;
    const std::size_t planes_;
    std::size_t index_ = 0;
    std::uint64_t end_ = 0;  // of the block before
};

std::vector<std::byte> residualsOf(std::span<const StoredNode> nodes);
std::vector<std::byte> residualsOf(std::span<const BlockPlace> places, std::span<const StoredNode> nodes,
                                   std::size_t planes);

/// Deterministic: the same records give the same bytes.
std::vector<std::byte> packRecords(std::span<const std::byte> records, const PackedLayout& layout);

/// Takes a packed index apart, chunk by chunk.
class RecordUnpacker {
  public:
    RecordUnpacker(const PackedLayout& layout, std::uint64_t records) : layout_(layout), left_(records) {}

    /// The next records, up to chunkRecords of them; good until the next call. `stored` holds the rest of the index or
    /// layout.longestChunk() bytes of it, and loses what was used. Malformed if these are not such records, or all of them
    /// have been.
    Expected<std::span<std::byte>> next(std::span<const std::byte>& stored);
    std::uint64_t left() const { return left_; }

  private:
    const PackedLayout layout_;
    std::uint64_t left_;
    std::vector<std::byte> planes_, records_;
};

}  // namespace scancast
