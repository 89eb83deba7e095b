// Decodes points that somebody else fetched: requests on one descriptor, answers on another, one after the other until the requests end
// (renderer/cloud/import/stream/chunk_messages.hpp). Opens nothing. Pipeline: request → **chunk** → records → answer.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "renderer/cloud/import/stream/chunk_messages.hpp"

namespace scancast {

/// The records of one chunk. `laszip`: the content of the record that says how chunks of LAZ are compressed. Errors without a name: Malformed,
/// Truncated, Unsupported, ResourceLimit.
using DecodeChunk = std::function<Expected<std::vector<std::byte>>(const chunk_messages::RequestHead& head,
                                                                   std::span<const std::byte> laszip,
                                                                   std::span<const std::byte> chunk)>;

/// False when the requests do not end where a request does, or nobody takes the answers.
bool serveChunks(int requests, int answers, const DecodeChunk& decode);

}  // namespace scancast
