// A tile of an EPT set, which somebody else fetched whole (importers/chunk_service.hpp): a file of LAZ or LAS, or records that zstd has
// compressed. Pure function on bytes. Pipeline: request → **tile** → records.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/import/stream/chunk_messages.hpp"

namespace scancast::import_octree {

/// Its records, as many as the request says, no fewer and no more. Errors without a name: Malformed, Truncated, Unsupported (it is packed
/// otherwise), ResourceLimit.
Expected<std::vector<std::byte>> decodeTile(const chunk_messages::RequestHead& head,
                                            std::span<const std::byte> laszip,
                                            std::span<const std::byte> tile);

}  // namespace scancast::import_octree
