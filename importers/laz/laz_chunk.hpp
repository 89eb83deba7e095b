// One chunk of a LAZ file, which somebody else took out of it (importers/chunk_service.hpp). Pure function on bytes.
// Pipeline: request → **chunk** → records.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/import/stream/chunk_messages.hpp"

namespace scancast::import_laz {

/// Its records, as LAS has them. `laszip`: the content of the record that says how they are compressed. Errors without a name:
/// Malformed, Truncated, Unsupported (it is packed otherwise), ResourceLimit.
Expected<std::vector<std::byte>> decodeChunk(const chunk_messages::RequestHead& head,
                                             std::span<const std::byte> laszip,
                                             std::span<const std::byte> chunk);

}  // namespace scancast::import_laz
