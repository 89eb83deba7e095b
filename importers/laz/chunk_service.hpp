// Decodes chunks that somebody else fetched: requests on one descriptor, answers on another, one after the other until the requests end
// (renderer/cloud/import/stream/chunk_messages.hpp). Opens nothing. Pipeline: request → **chunk** → records → answer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/import/stream/chunk_messages.hpp"

namespace scancast::import_laz {

/// The records of one chunk, as LAS has them. `laszip`: the content of the record that says how they are compressed. Errors without a name:
/// Malformed, Truncated, Unsupported, ResourceLimit.
Expected<std::vector<std::byte>> decodeChunk(const chunk_messages::RequestHead& head,
                                             std::span<const std::byte> laszip,
                                             std::span<const std::byte> chunk);

/// False when the requests do not end where a request does, or nobody takes the answers.
bool serveChunks(int requests, int answers);

}  // namespace scancast::import_laz
