// What must be true of a cloud file's nodes before anybody walks over them. Pure function; any thread.
// Pipeline: cloud file → **checked index** → residency, selection.
#pragma once

#include <cstdint>
#include <span>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

/// Numbering breadth first with children side by side, parents, levels, counts that add up, finite boxes,
/// spacings that do not grow downwards, blocks of samples as wrongBlock() wants them. Malformed, with the node
/// and what is wrong, without the file's name.
Expected<void> checkNodes(std::span<const StoredNode> nodes, const CloudFacts& facts,
                          std::uint64_t indexOffset);

/// What is wrong with the place of a block that decodes to so many bytes: it lies within [first byte behind the
/// header, indexOffset) and is large enough; a block of nothing has no place. nullptr = nothing.
const char* wrongBlock(const BlockPlace& place, std::uint64_t decodedBytes, std::uint64_t indexOffset);

}  // namespace scancast
