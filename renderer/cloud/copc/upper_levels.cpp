#include "renderer/cloud/copc/upper_levels.hpp"

#include <algorithm>
#include <glm/vec3.hpp>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/nodes/spacing.hpp"
#include "renderer/cloud/copc/raw_points.hpp"

namespace scancast {

namespace {

constexpr std::uint64_t mostPoints = 200'000;
// Where nobody can measure it: the usual root of COPC has 128 points along a side.
constexpr double usualPointsPerSide = 128;

/// Records in memory as a scan.
class RecordsSource final : public PointSource {
  public:
    RecordsSource(LasReader las, std::vector<std::vector<std::byte>> records)
        : las_(std::move(las)), records_(std::move(records)), header_(las_.header()) {
        std::uint64_t points = 0;
        for (const auto& chunk : records_) points += chunk.size() / las_.las().recordBytes;
        header_.points = points;
        header_.attributes.nearInfrared = false;
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        while (next_ < records_.size() && at_ >= records_[next_].size()) ++next_, at_ = 0;
        batch.clear();
        if (next_ == records_.size()) return false;
        const std::size_t most = batchPoints * las_.las().recordBytes;
        const auto piece = std::span<const std::byte>(records_[next_])
                               .subspan(at_)
                               .first(std::min(most, records_[next_].size() - at_));
        at_ += piece.size();
        if (auto ok = las_.decode(piece, batch); !ok) return passOn(ok);
        batch.nearInfrared.clear();
        return true;
    }
    std::uint64_t droppedPoints() const override { return las_.droppedPoints(); }
    std::vector<std::string> notes() const override { return las_.notes(); }

  private:
    LasReader las_;
    const std::vector<std::vector<std::byte>> records_;
    ScanHeader header_;
    std::size_t next_ = 0, at_ = 0;
};

}  // namespace

std::vector<std::uint32_t> upperVoxels(const CopcHierarchy& hierarchy, std::uint64_t enough) {
    std::vector<std::uint32_t> upper;
    std::uint64_t points = 0;
    // Voxels stand by level.
    for (std::uint32_t first = 0; first < hierarchy.voxels.size() && points < enough;) {
        std::uint32_t end = first;
        std::uint64_t more = 0;
        for (; end < hierarchy.voxels.size() &&
               hierarchy.voxels[end].key.level == hierarchy.voxels[first].key.level;
             ++end)
            more += hierarchy.voxels[end].points;
        if (points > 0 && points + more > mostPoints) break;
        // Where the levels above are empty, some voxels of the first that has points stand for all.
        const std::uint64_t every = more / mostPoints + 1;
        std::uint64_t met = 0;
        for (std::uint32_t voxel = first; voxel < end; ++voxel)
            if (hierarchy.voxels[voxel].points > 0 && met++ % every == 0) upper.push_back(voxel);
        points += more;
        first = end;
    }
    return upper;
}

Expected<std::shared_ptr<const Cloud>> upperCloud(LasReader las, std::vector<std::vector<std::byte>> records,
                                                  const std::string& title, bool surfels) {
    RecordsSource source(std::move(las), std::move(records));
    BuildOptions options{.title = title};
    options.shape.surfels = surfels;
    options.shape.curvature = false;
    options.shape.orientation = Orientation::Scan;  // as the nodes are, which do not know each other
    return buildCloud(source, options);
}

RootSpacing rootSpacing(std::span<const std::byte> records, const LasReader& las, const CopcInfo& info) {
    const double usual = 2 * info.halfSize / usualPointsPerSide;
    if (records.empty()) return {usual, usual};
    const auto points = rawPointsOf(records, las.las(), LasColorDepth::SixteenBits);
    if (!points || points->empty()) return {usual, usual};
    // In Morton order of a lattice over the cube, which is as fine as samples are.
    const StepGrid grid = las.las().grid();
    AdditiveFrame frame{
        info, grid, info.center, {info.center - info.halfSize, info.center + info.halfSize}, {}};
    CopcHierarchy alone;
    CopcVoxel& root = alone.voxels.emplace_back();
    root.points = std::uint32_t(points->size());
    root.below = root.points;
    const auto tree = additiveTree(alone, frame);
    if (!tree) return {usual, usual};
    const auto samples = samplesOf(*points, tree->own.front().lattice);
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
