// What a cloud file keeps beside its samples, and what must be true of it before anybody reads it: the planes, or
// in version 1 the rows. Pure functions; any thread.
// Pipeline: cloud file → **checked index of planes** → cloud file's readers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

/// Of one row of these columns.
std::size_t rowBytes(std::span<const KeptColumn> columns);

/// Blocks of one kind, at most one a node, each of as many records as its node has samples.
struct BlockList {
    std::string what;             ///< for messages: "plane gps_time", "rows"
    std::size_t recordBytes = 0;  ///< 0: nobody has such a block
    bool inInnerNodes = false;
    bool mayBeMissing = false;  ///< in some of the nodes that could have one
};

/// One list for each of planesOf(facts). Version 1: one, of rows.
std::vector<BlockList> listsBesideSamples(const CloudFacts& facts, std::uint32_t version);

/// `places`: one for each node and list, node by node. All of them as wrongBlock() wants them, and none where
/// none may be. Malformed, with node, list and what is wrong, without the file's name.
Expected<void> checkPlaces(std::span<const BlockPlace> places, std::span<const BlockList> lists,
                           std::span<const StoredNode> nodes, std::uint64_t indexOffset);

}  // namespace scancast
