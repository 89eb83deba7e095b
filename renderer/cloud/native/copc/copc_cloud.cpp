#include "renderer/cloud/native/copc/copc_cloud.hpp"

#include <fmt/format.h>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/native/copc/copc_head.hpp"
#include "renderer/cloud/native/copc/copc_hierarchy.hpp"
#include "threads/guarded.hpp"

namespace scancast {

namespace {

class CopcVoxels final : public VoxelSource {
  public:
    CopcVoxels(std::unique_ptr<RandomReader> reader, std::shared_ptr<ChunkDecoders> decoders)
        : reader_(std::move(reader)), decoders_(std::move(decoders)) {}

    Expected<void> open() {
        auto head = readCopcHead(*reader_);
        if (!head) return passOn(std::move(head));
        auto tree = readCopcHierarchy(*reader_, head->info);
        if (!tree) return passOn(std::move(tree));
        const LasHeader& las = head->las.las();
        shape_ = std::move(head->shape);
        shape_.owner = newSource();
        scan_.header = head->las.header();
        scan_.header.format =
            fmt::format("COPC 1.0, LAS 1.{}, point format {}", las.minorVersion, las.pointFormat);
        scan_.header.bounds = las.bounds;
        scan_.header.points = tree->points;
        scan_.cube = head->info.cube;
        scan_.grid = las.grid();
        scan_.records = std::make_shared<const import_octree::LasDecoder>(las, std::vector<LasColumn>());
        auto columns = head->las.allColumns();
        for (const LasColumn& column : columns) scan_.columns.push_back(column.column);
        scan_.everything = std::make_shared<const import_octree::LasDecoder>(las, std::move(columns));
        scan_.notes = head->las.notes();
        if (tree->points != las.points)
            scan_.notes.push_back(fmt::format("its header promises {} points, and its octree has {}",
                                              grouped(las.points), grouped(tree->points)));
        scan_.digest = head->digest;
        scan_.tree = std::move(*tree);
        return {};
    }

    const NativeScan& scan() const override { return scan_; }
    void expect(std::uint32_t voxel) const override {
        reader_->expect(scan_.tree.voxels[voxel].offset, scan_.tree.voxels[voxel].bytes);
    }
    Expected<std::vector<std::byte>> records(std::uint32_t index) const override {
        const Voxel& voxel = scan_.tree.voxels[index];
        std::vector<std::byte> chunk(voxel.bytes);
        // What came over a network may be sound the second time.
        for (int tries = 2;; --tries) {
            const auto got = reader_->readAt(voxel.offset, chunk);
            if (!got) return passOn(got);
            if (*got < chunk.size())
                return fail(
                    ErrorCode::Truncated,
                    fmt::format("it ends at byte {}, within the points of a voxel", voxel.offset + *got));
            auto records = decoders_->decode(shape_, voxel.points, chunk);
            if (records || tries == 1 || !reader_->forget(voxel.offset, voxel.bytes)) return records;
        }
    }
    std::uint64_t bytes() const override { return reader_->size(); }
    bool isRemote() const override { return reader_->isRemote(); }
    bool isAway() const override { return reader_->isAway(); }

  private:
    const std::unique_ptr<RandomReader> reader_;
    const std::shared_ptr<ChunkDecoders> decoders_;
    ChunkShape shape_;
    NativeScan scan_;
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> openCopc(std::unique_ptr<RandomReader> reader,
                                                    std::shared_ptr<ChunkDecoders> decoders,
                                                    NativeCloudOptions options) {
    auto voxels = std::make_unique<CopcVoxels>(std::move(reader), std::move(decoders));
    Expected<std::unique_ptr<VoxelSource>> source;
    if (auto ok = guarded("Opening COPC", [&] { return voxels->open(); }); !ok)
        source = passOn(std::move(ok));
    else
        source = std::move(voxels);
    return openNativeCloud(std::move(source), std::move(options));
}

}  // namespace scancast
