// Where finished blocks go while an octree is built: a cloud file, or a room from which they come into one later. Owned and used by
// one thread, except where said. Pipeline: octree builder → **blocks** → cloud file.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

class BlockSink {
  public:
    virtual ~BlockSink() = default;
    /// Places follow each other in the order of the calls. Errors: Io; ResourceLimit for a full disk, naming the place and the bytes.
    virtual Expected<BlockPlace> append(std::span<const std::byte> block) = 0;
    /// A block appended earlier, checked. Any thread, while nobody appends.
    virtual Expected<std::vector<std::byte>> readBack(const BlockPlace& place) const = 0;
};

}  // namespace scancast
