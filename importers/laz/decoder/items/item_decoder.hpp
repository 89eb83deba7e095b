// Decoders of the items that a record is made of, by the kinds, versions and names of LASzip ("LAZ Specification 1.4"). Each
// knows its item of the record before, and what its models have learnt since the chunk began. Owned by a chunk's decoder.
//
// Point formats 0-5 have all their items in one stream; 6-10 have layers, a stream for each field, so that whoever wants few
// fields reads few bytes. A layer without bytes is a field that stays what it is in the chunk's first record.
#pragma once

#include <memory>
#include <span>

#include "importers/laz/decoder/arithmetic_decoder.hpp"
#include "importers/laz/decoder/laszip_record.hpp"

namespace scancast::laz {

class ItemDecoder {
  public:
    virtual ~ItemDecoder() = default;
    /// Begins a chunk, of whose first record `item` is the item's part.
    virtual void start(const std::byte* item) = 0;
    /// Writes the next record's item.
    virtual void decode(std::byte* item) = 0;
};

/// `item`: of kinds Bytes to WavePacket13, of a version that parseLaszipRecord() lets pass.
std::unique_ptr<ItemDecoder> makeItemDecoder(const Item& item, ArithmeticDecoder& decoder);

/// Models learn for each scanner channel apart.
inline constexpr std::size_t channels = 4;

class LayeredItemDecoder {
  public:
    virtual ~LayeredItemDecoder() = default;
    /// How many layers it has.
    virtual std::size_t layers() const = 0;
    /// Whether the layer is needed for anything but the item itself.
    virtual bool leads(std::size_t /*layer*/) const { return false; }
    /// `channel` is what the point decides by its scanner channel, and the other items go by.
    virtual void start(const std::byte* item, std::span<ArithmeticDecoder> layers, std::size_t& channel) = 0;
    virtual void decode(std::byte* item, std::size_t& channel) = 0;
};

/// `item`: of kinds Point14 to Bytes14.
std::unique_ptr<LayeredItemDecoder> makeLayeredItemDecoder(const Item& item);

}  // namespace scancast::laz
