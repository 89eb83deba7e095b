// An Entwine Point Tile set as a native cloud: description, hierarchy, and its tiles, one file for each voxel, fetched here. Tiles of LAZ and
// those that zstd has compressed are decoded elsewhere; those of plain records are read as they are. Names of files are made of voxels'
// keys, never of what a file says. Any thread; waits for the files and for decoders. Pipeline: EPT set → **voxels** → native cloud.
#pragma once

#include "files/folder_reader.hpp"
#include "renderer/cloud/native/chunk_decoders.hpp"
#include "renderer/cloud/native/native_cloud.hpp"

namespace scancast {

/// The file that describes a set, in its folder.
inline constexpr const char* eptDescriptionName = "ept.json";

/// Errors, with the set's name: NotFound, Truncated, Malformed, Unsupported, Empty, Importer; ResourceLimit, with the way out; the files'.
Expected<std::shared_ptr<const CloudFile>> openEpt(std::shared_ptr<const FolderReader> files,
                                                   std::shared_ptr<ChunkDecoders> decoders,
                                                   NativeCloudOptions options);

}  // namespace scancast
