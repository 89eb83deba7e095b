// Where a node's samples and the values beside them stand in a cloud file. Plain values.
#pragma once

#include <cstdint>

#include "renderer/cloud/octree.hpp"

namespace scancast {

struct BlockPlace {
    std::uint64_t offset = 0;    ///< from the start of the file
    std::uint32_t bytes = 0;     ///< as stored; 0 = there is none
    std::uint64_t checksum = 0;  ///< XXH3, 64 bits, of the bytes as stored
    bool operator==(const BlockPlace&) const = default;
};

struct StoredNode {
    Node node;
    BlockPlace samples;
};

}  // namespace scancast
