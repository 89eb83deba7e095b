// Where a native cloud has its scan from: what a format says of it before any point is read - octree, grid, what records mean -, and each
// voxel's records. One for each format (copc/, ept/). Owned by the native cloud. *Thread safety*: everything from any number of threads.
// Pipeline: format → **voxel source** → raw points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/import/octree/record_decoder.hpp"
#include "renderer/cloud/native/voxel_tree.hpp"

namespace scancast {

/// What is known of a scan before its points are.
struct NativeScan {
    /// Format, attributes, coordinate reference system; bounds: where all points should lie. No columns: none are kept beside samples.
    ScanHeader header;
    VoxelCube cube;
    /// What points are drawn on: the scan's own; of positions that are floating-point numbers, one that is finer than any sample.
    StepGrid grid;
    bool isGridOwn = true;
    std::shared_ptr<const import_octree::RecordDecoder> records;  ///< what they mean
    /// The same with all that is known of a point besides, `columns`: for who asks for one.
    std::shared_ptr<const import_octree::RecordDecoder> everything;
    std::vector<Column> columns;
    VoxelTree tree;
    std::vector<std::string> notes;
    std::uint64_t digest = 0;  ///< of everything but the points
};

class VoxelSource {
  public:
    virtual ~VoxelSource() = default;
    virtual const NativeScan& scan() const = 0;

    /// It will be read soon: where that takes a while, it begins now. Never waits.
    virtual void expect(std::uint32_t voxel) const = 0;
    /// Those of a voxel that has points; exactly as many as it should have. Waits for what it is read from, and for decoders. Errors without
    /// the scan's name: Malformed, Truncated, NotFound: it is damaged; Importer, Io; Unavailable.
    virtual Expected<std::vector<std::byte>> records(std::uint32_t voxel) const = 0;

    /// Size of the scan, compressed; 0 where nobody knows.
    virtual std::uint64_t bytes() const = 0;
    virtual bool isRemote() const = 0;
    virtual bool isAway() const = 0;
};

}  // namespace scancast
