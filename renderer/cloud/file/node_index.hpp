// What must be true of a cloud file's nodes before anybody walks over them. Pure function; any thread.
// Pipeline: cloud file → **checked index** → residency, selection.
#pragma once

#include <cstdint>
#include <span>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

/// Of one row of these columns.
std::size_t rowBytes(std::span<const KeptColumn> columns);

/// Numbering breadth first with children side by side, parents, levels, counts that add up, finite boxes,
/// spacings that do not grow downwards, blocks within [first byte behind the header, indexOffset) and large
/// enough for what they should decode to. Malformed, with the node and what is wrong, without the file's
/// name.
Expected<void> checkNodes(std::span<const StoredNode> nodes, const CloudFacts& facts,
                          std::uint64_t indexOffset);

}  // namespace scancast
