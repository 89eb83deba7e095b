// The chunks of a COPC file's voxels: fetched, and decoded elsewhere. Any thread; waits for the reader and for decoders.
// Pipeline: hierarchy → **chunks** → records → raw points.
#pragma once

#include "files/random_reader.hpp"
#include "renderer/cloud/copc/chunk_decoders.hpp"
#include "renderer/cloud/copc/copc_hierarchy.hpp"

namespace scancast {

/// Chunks of a file, fetched and decoded. Errors without its name.
class VoxelChunks {
  public:
    VoxelChunks(const RandomReader& reader, ChunkDecoders& decoders, const ChunkShape& shape,
                const CopcHierarchy& hierarchy)
        : reader_(reader), decoders_(decoders), shape_(shape), hierarchy_(hierarchy) {}

    void expect(std::uint32_t voxel) const {
        reader_.expect(hierarchy_.voxels[voxel].offset, hierarchy_.voxels[voxel].bytes);
    }

    Expected<std::vector<std::byte>> records(std::uint32_t voxel) const;

  private:
    const RandomReader& reader_;
    ChunkDecoders& decoders_;
    const ChunkShape& shape_;
    const CopcHierarchy& hierarchy_;
};

}  // namespace scancast
