#include "renderer/cloud/native/upper_levels.hpp"

#include <algorithm>
#include <glm/vec3.hpp>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/nodes/spacing.hpp"

namespace scancast {

namespace {

constexpr std::uint64_t mostPoints = 200'000;
// Each is a request, where they come over a network.
constexpr std::uint64_t mostVoxels = 512;
// Where nobody can measure it: the usual root of COPC has 128 points along a side.
constexpr double usualPointsPerSide = 128;

/// Records in memory as a scan.
class RecordsSource final : public PointSource {
  public:
    RecordsSource(const NativeScan& scan, LasColorDepth depth, std::vector<std::vector<std::byte>> records)
        : decoder_(*scan.records),
          depth_(depth),
          records_(std::move(records)),
          header_(scan.header),
          notes_(scan.notes) {
        std::uint64_t points = 0;
        for (const auto& one : records_) points += one.size() / decoder_.recordBytes();
        header_.points = points;
        // Nothing that nodes do not have, either.
        header_.attributes.nearInfrared = header_.attributes.normal = false;
        header_.columns.clear();
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        while (next_ < records_.size() && at_ >= records_[next_].size()) ++next_, at_ = 0;
        batch.clear();
        if (next_ == records_.size()) return false;
        const std::size_t most = batchPoints * decoder_.recordBytes();
        const auto piece = std::span<const std::byte>(records_[next_])
                               .subspan(at_)
                               .first(std::min(most, records_[next_].size() - at_));
        at_ += piece.size();
        std::swap(decoded_.batch, batch);
        decoder_.decode(piece, depth_, decoded_);
        std::swap(decoded_.batch, batch);
        batch.normal.clear();
        batch.nearInfrared.clear();
        batch.rows.clear();
        return true;
    }
    std::uint64_t droppedPoints() const override { return decoded_.dropped; }
    std::vector<std::string> notes() const override {
        std::vector<std::string> notes = notes_;
        if (decoded_.outside > 0)
            notes.push_back(grouped(decoded_.outside) +
                            " of the numbers in its upper levels are outside of what is kept of them "
                            "(intensities and colours of 0 to 65,535, classes of 0 to 255)");
        return notes;
    }

  private:
    const import_octree::RecordDecoder& decoder_;
    const LasColorDepth depth_;
    const std::vector<std::vector<std::byte>> records_;
    ScanHeader header_;
    const std::vector<std::string> notes_;
    import_octree::DecodedPoints decoded_;
    std::size_t next_ = 0, at_ = 0;
};

}  // namespace

std::vector<std::uint32_t> upperVoxels(const VoxelTree& hierarchy, std::uint64_t enough) {
    std::vector<std::uint32_t> upper;
    std::uint64_t points = 0;
    // Voxels stand by level.
    for (std::uint32_t first = 0; first < hierarchy.voxels.size() && points < enough;) {
        std::uint32_t end = first;
        std::uint64_t more = 0, count = 0;
        for (; end < hierarchy.voxels.size() &&
               hierarchy.voxels[end].key.level == hierarchy.voxels[first].key.level;
             ++end)
            more += hierarchy.voxels[end].points, count += hierarchy.voxels[end].points > 0 ? 1 : 0;
        if (points > 0 && (points + more > mostPoints || upper.size() + count > mostVoxels)) break;
        // Where the levels above are empty, some voxels of the first that has points stand for all.
        const std::uint64_t every = std::max(more / mostPoints + 1, (count + mostVoxels - 1) / mostVoxels);
        std::uint64_t met = 0;
        for (std::uint32_t voxel = first; voxel < end; ++voxel)
            if (hierarchy.voxels[voxel].points > 0 && met++ % every == 0) upper.push_back(voxel);
        points += more;
        first = end;
    }
    return upper;
}

Expected<std::shared_ptr<const Cloud>> upperCloud(const NativeScan& scan, LasColorDepth depth,
                                                  std::vector<std::vector<std::byte>> records,
                                                  const std::string& title, bool surfels) {
    RecordsSource source(scan, depth, std::move(records));
    BuildOptions options{.title = title};
    options.shape.surfels = surfels;
    options.shape.curvature = false;
    options.shape.orientation = Orientation::Scan;  // as the nodes are, which do not know each other
    return buildCloud(source, options);
}

RootSpacing rootSpacing(std::span<const RawPoint> points, const NativeScan& scan) {
    const VoxelCube& cube = scan.cube;
    const double usual = 2 * cube.halfSize / usualPointsPerSide;
    if (points.empty()) return {usual, usual};
    // In Morton order of a lattice over the cube, which is as fine as samples are.
    const AdditiveFrame frame{
        cube, scan.grid, cube.center, {cube.center - cube.halfSize, cube.center + cube.halfSize}, {}};
    VoxelTree alone;
    Voxel& root = alone.voxels.emplace_back();
    root.points = std::uint32_t(points.size());
    root.below = root.points;
    const auto tree = additiveTree(alone, frame);
    if (!tree) return {usual, usual};
    const auto samples = samplesOf(points, tree->own.front().lattice);
    if (!samples) return {usual, usual};
    std::vector<glm::vec3> positions;
    positions.reserve(samples->size());
    for (const Sample& s : *samples)
        positions.emplace_back(tree->nodes.front().node.step * glm::dvec3(s.x, s.y, s.z));
    const Spacing spacing = estimateSpacing(positions);
    if (!(spacing.mean > 0) || !(spacing.closing > 0)) return {usual, usual};
    return {spacing.mean, std::max(spacing.mean, spacing.closing)};
}

}  // namespace scancast
