// A COPC file as a native cloud: head, hierarchy, and the chunks of its voxels, fetched here and decoded elsewhere.
// Any thread; waits for the reader and for decoders. Pipeline: COPC file → **voxels** → native cloud.
#pragma once

#include "files/random_reader.hpp"
#include "renderer/cloud/native/chunk_decoders.hpp"
#include "renderer/cloud/native/native_cloud.hpp"

namespace scancast {

/// Errors, with the file's name: Truncated, Malformed, Unsupported, Empty, Importer; ResourceLimit, with the way out; the reader's.
Expected<std::shared_ptr<const CloudFile>> openCopc(std::unique_ptr<RandomReader> reader,
                                                    std::shared_ptr<ChunkDecoders> decoders,
                                                    NativeCloudOptions options);

}  // namespace scancast
