#include "renderer/cloud/copc/voxel_chunks.hpp"

#include <fmt/format.h>

namespace scancast {

Expected<std::vector<std::byte>> VoxelChunks::records(std::uint32_t index) const {
    const CopcVoxel& voxel = hierarchy_.voxels[index];
    std::vector<std::byte> chunk(voxel.bytes);
    // What came over a network may be sound the second time.
    for (int tries = 2;; --tries) {
        const auto got = reader_.readAt(voxel.offset, chunk);
        if (!got) return passOn(got);
        if (*got < chunk.size())
            return fail(ErrorCode::Truncated,
                        fmt::format("it ends at byte {}, within the points of a voxel", voxel.offset + *got));
        auto records = decoders_.decode(shape_, voxel.points, chunk);
        if (records || tries == 1 || !reader_.forget(voxel.offset, voxel.bytes)) return records;
    }
}

}  // namespace scancast
