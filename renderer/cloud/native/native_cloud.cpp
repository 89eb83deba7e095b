#include "renderer/cloud/native/native_cloud.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>
#include <thread>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/native/computing_turn.hpp"
#include "renderer/cloud/native/node_surfels.hpp"
#include "renderer/cloud/native/upper_levels.hpp"
#include "threads/guarded.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

constexpr std::size_t upperThreads = 4;
constexpr std::uint64_t usualMemory = 64 << 20;

/// All that is known when it is open; what refers to each other stays where it is.
struct Opened {
    std::unique_ptr<VoxelSource> source;
    NativeCloudOptions options;
    LasColorDepth depth = LasColorDepth::Unknown;
    AdditiveFrame frame;
    AdditiveTree tree;
    CloudFacts facts;
    std::vector<RawPoints> upper;  ///< own points of upper voxels, by voxel; stay
};

class NativeCloud final : public CloudFile {
  public:
    explicit NativeCloud(std::unique_ptr<Opened> opened)
        : opened_(std::move(opened)),
          gathered_(opened_->tree, opened_->source->scan().tree, opened_->frame, opened_->options.memory,
                    [this](std::uint32_t voxel) { return own(voxel); }) {}

    const fs::path& path() const override { return opened_->options.name; }
    std::uint64_t bytes() const override { return opened_->source->bytes(); }
    bool isRemote() const override { return opened_->source->isRemote(); }
    bool isAway() const override { return opened_->source->isAway(); }
    bool isNative() const override { return true; }
    std::uint64_t ownMemory() const override {
        std::uint64_t bytes = opened_->source->scan().tree.voxels.size() * sizeof(Voxel) +
                              opened_->tree.own.size() * sizeof(AdditiveNode);
        for (const RawPoints& points : opened_->upper)
            if (points) bytes += points->size() * sizeof(RawPoint);
        return bytes;
    }
    const CloudFacts& facts() const override { return opened_->facts; }
    std::span<const StoredNode> nodes() const override { return opened_->tree.nodes; }

    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        try {
            if (node >= nodes().size())
                return fail(ErrorCode::InvalidArgument, fmt::format("{} has {} nodes, and no node {}",
                                                                    path().string(), nodes().size(), node));
            for (const std::uint32_t voxel : gathered_.missingFor(node))
                if (!upper(voxel)) opened_->source->expect(voxel);
            const auto points = gathered_.of(node);
            if (!points) return named(node, points.error());
            const ComputingTurn computing;
            auto samples = samplesOf(**points, opened_->tree.own[node].lattice);
            if (!samples) return named(node, samples.error());
            if (opened_->options.surfels) addNodeSurfels(nodes()[node].node, *samples);
            return samples;
        } catch (const std::bad_alloc&) {
            return fail(ErrorCode::ResourceLimit,
                        path().string() + ": there is not enough memory for one block of it");
        }
    }

    std::span<const ValuePlane> planes() const override { return {}; }
    Expected<Bytes> plane(std::uint32_t, std::size_t index) const override {
        return fail(ErrorCode::InvalidArgument, fmt::format("{} has no plane {}", path().string(), index));
    }
    BlockPlace planePlace(std::uint32_t, std::size_t) const override { return {}; }
    Expected<Bytes> rows(std::uint32_t) const override { return Bytes(); }

    /// Samples have lost whose records they were: the first that gives this sample is the point, of the voxel itself, then of those
    /// above.
    Expected<KeptPoint> point(std::uint32_t leaf, std::span<const Sample> samples,
                              std::size_t index) const override {
        const Sample& sample = samples[index];
        for (std::uint32_t node = leaf; node != noNode; node = nodes()[node].node.parent) {
            const std::uint32_t voxel = opened_->tree.own[node].voxel;
            if (voxel == noVoxel || opened_->source->scan().tree.voxels[voxel].points == 0) continue;
            const auto records = opened_->source->records(voxel);
            if (!records) return named(node, records.error());
            auto found = findRecord(*records, sample, opened_->tree.own[leaf].lattice);
            if (!found) return named(node, found.error());
            if (*found) return std::move(**found);
        }
        return named(leaf, {ErrorCode::Malformed, "a point of it is not in its file any more", {}});
    }

  private:
    RawPoints upper(std::uint32_t voxel) const {
        return voxel < opened_->upper.size() ? opened_->upper[voxel] : nullptr;
    }

    Expected<RawPoints> own(std::uint32_t voxel) const {
        if (auto known = upper(voxel)) return known;
        const auto records = opened_->source->records(voxel);
        if (!records) return passOn(records);
        const NativeScan& scan = opened_->source->scan();
        auto points = rawPointsOf(*records, *scan.records, opened_->depth, scan.grid);
        if (!points) return passOn(std::move(points));
        return std::make_shared<const std::vector<RawPoint>>(std::move(*points));
    }

    Expected<std::optional<KeptPoint>> findRecord(std::span<const std::byte> records, const Sample& sample,
                                                  const NodeLattice& lattice) const {
        const NativeScan& scan = opened_->source->scan();
        const auto points = rawPointsOf(records, *scan.records, opened_->depth, scan.grid);
        if (!points) return passOn(points);
        const auto gives = [&](const RawPoint& point) {
            const auto at = onLattice(point, lattice);
            return at && *at == std::array{sample.x, sample.y, sample.z} &&
                   point.intensity == sample.intensity && point.classification == sample.classification &&
                   point.color == std::array{sample.r, sample.g, sample.b};
        };
        const auto at = std::ranges::find_if(*points, gives);
        if (at == points->end()) return std::nullopt;
        const std::size_t stride = scan.everything->recordBytes();
        import_octree::DecodedPoints one;
        scan.everything->decode(records.subspan(std::size_t(at - points->begin()) * stride, stride),
                                opened_->depth, one);
        const PointBatch& batch = one.batch;
        KeptPoint kept{batch.position.front(), scan.grid.step,           true, {},
                       scan.columns,           std::move(one.batch.rows)};
        // Floating-point numbers: the neighbours of this one.
        if (!scan.isGridOwn)
            for (int a = 0; a < 3; ++a)
                kept.precision[a] =
                    std::nextafter(std::abs(kept.position[a]), HUGE_VAL) - std::abs(kept.position[a]);
        if (!batch.normal.empty() && glm::dot(batch.normal[0], batch.normal[0]) > 0)
            kept.normal = glm::dvec3(batch.normal[0]);
        return kept;
    }

    tl::unexpected<Error> named(std::uint32_t node, const Error& error) const {
        return fail(error.code, fmt::format("{}, voxel {}: {}", path().string(),
                                            text(opened_->tree.own[node].key), error.message));
    }

    const std::unique_ptr<Opened> opened_;
    mutable GatheredPoints gathered_;
};

/// Errors without the scan's name.
class Opening {
  public:
    Opening(std::unique_ptr<VoxelSource> source, NativeCloudOptions options)
        : opened_(std::make_unique<Opened>()), scan_(source->scan()) {
        opened_->source = std::move(source);
        opened_->options = std::move(options);
        if (!opened_->options.memory) opened_->options.memory = std::make_shared<GatheredMemory>(usualMemory);
    }

    Expected<std::shared_ptr<const CloudFile>> run() {
        auto records = upperRecords();
        if (!records) return passOn(std::move(records));
        for (const Bytes& one : *records)
            opened_->depth = std::max(opened_->depth, scan_.records->colorDepth(one));
        if (auto ok = keepUpper(*records); !ok) return passOn(ok);
        const RawPoints root = opened_->upper.empty() ? nullptr : opened_->upper.front();
        const auto rootPoints = root ? std::span<const RawPoint>(*root) : std::span<const RawPoint>();
        opened_->frame = {scan_.cube, scan_.grid, {}, bounds(), rootSpacing(rootPoints, scan_)};
        const auto upper = upperCloud(scan_, opened_->depth, std::move(*records), opened_->options.title,
                                      opened_->options.surfels);
        if (!upper) return passOn(upper);
        opened_->frame.origin = (*upper)->origin;
        // Some headers have the bounds of another tile.
        auto& [low, high] = opened_->frame.bounds;
        low = glm::min(low, (*upper)->bounds[0]), high = glm::max(high, (*upper)->bounds[1]);
        auto tree = additiveTree(scan_.tree, opened_->frame);
        if (!tree) return passOn(std::move(tree));
        opened_->tree = std::move(*tree);
        // A cube that is elsewhere than the points would damage every block.
        if (root)
            if (const auto samples = samplesOf(*root, opened_->tree.own.front().lattice); !samples)
                return passOn(samples);
        fillFacts(*upper);
        return std::make_shared<const NativeCloud>(std::move(opened_));
    }

  private:
    /// The header's where they can be meant; else the cube.
    std::array<glm::dvec3, 2> bounds() const {
        const VoxelCube& cube = scan_.cube;
        const glm::dvec3 low = cube.center - cube.halfSize, high = cube.center + cube.halfSize;
        if (!scan_.header.bounds) return {low, high};
        const auto [first, last] = *scan_.header.bounds;
        const double more = cube.halfSize / 4;
        for (int a = 0; a < 3; ++a)
            if (!(first[a] <= last[a] && first[a] >= low[a] - more && last[a] <= high[a] + more))
                return {low, high};
        return {first, last};
    }

    /// Fetched all at once, and decoded by as many as there are. Those that are damaged are left out, but for the root.
    Expected<std::vector<Bytes>> upperRecords() {
        const auto wanted = upperVoxels(scan_.tree, opened_->options.upperPoints);
        for (const std::uint32_t voxel : wanted) opened_->source->expect(voxel);
        std::vector<Expected<Bytes>> got(wanted.size());
        std::atomic<std::size_t> next = 0;
        const auto work = [&] {
            for (std::size_t i = next++; i < got.size(); i = next++)
                got[i] = guarded("Reading a voxel", [&] { return opened_->source->records(wanted[i]); });
        };
        {
            // Not those that draw: these wait, for the network and for decoders.
            std::vector<std::jthread> threads;
            const std::size_t most = std::min(upperThreads, got.size());
            for (std::size_t i = 1; i < most; ++i) threads.emplace_back(work);
            work();
        }
        std::vector<Bytes> records;
        for (std::size_t i = 0; i < got.size(); ++i) {
            if (!got[i] && (wanted[i] == 0 || !isDamage(got[i].error().code)))
                return passOn(std::move(got[i]));
            if (!got[i]) {
                if (damaged_++ == 0) firstDamage_ = std::move(got[i].error());
                continue;
            }
            voxels_.push_back(wanted[i]);
            records.push_back(std::move(*got[i]));
        }
        if (records.empty()) return tl::unexpected(firstDamage_);
        return records;
    }

    static bool isDamage(ErrorCode code) {
        return code == ErrorCode::Malformed || code == ErrorCode::Truncated || code == ErrorCode::NotFound;
    }

    /// Records whose points cannot be are damaged as those that cannot be unpacked are: they are left out of `records`, too.
    Expected<void> keepUpper(std::vector<Bytes>& records) {
        opened_->upper.resize(voxels_.back() + 1);
        std::vector<Bytes> sound;
        for (std::size_t i = 0; i < voxels_.size(); ++i) {
            auto points = rawPointsOf(records[i], *scan_.records, opened_->depth, scan_.grid);
            if (!points && (voxels_[i] == 0 || !isDamage(points.error().code)))
                return passOn(std::move(points));
            if (!points) {
                if (damaged_++ == 0) firstDamage_ = std::move(points.error());
                continue;
            }
            opened_->upper[voxels_[i]] = std::make_shared<const std::vector<RawPoint>>(std::move(*points));
            sound.push_back(std::move(records[i]));
        }
        records = std::move(sound);
        if (records.empty()) return tl::unexpected(firstDamage_);
        return {};
    }

    void fillFacts(const std::shared_ptr<const Cloud>& upper) {
        CloudFacts& facts = opened_->facts;
        facts = *upper;
        const std::uint64_t seen = upper->points;
        facts.title = opened_->options.title;
        facts.points = scan_.tree.points;
        facts.bounds = opened_->frame.bounds;
        if (const auto& crs = opened_->options.crs) facts.crsWkt = crs->wkt, facts.crsEpsg = crs->epsg;
        facts.mirrors = opened_->options.mirrors;
        facts.grid.reset();
        if (scan_.isGridOwn) facts.grid = ScanGrid{scan_.grid.origin, scan_.grid.step};
        facts.spacing = meanSpacing();
        // What each node finds out by itself has no side; there is nothing beside it.
        facts.oriented = false;
        facts.sides.reset();
        facts.companions.clear();
        if (damaged_ > 0)
            facts.notes.push_back(fmt::format("{} of its upper levels cannot be read, and are left out: {}",
                                              counted(damaged_, "voxel"), firstDamage_.message));
        if (seen < scan_.tree.points)
            facts.notes.push_back(fmt::format(
                "it is shown as it is, without ingest: ranges, classes and colours are those of {} points "
                "of its upper levels",
                grouped(seen)));
        std::string all = fmt::format("{}\n{:016x} {:016x} {}\n{}", upper->revision, scan_.digest,
                                      scan_.tree.digest, opened_->options.surfels, opened_->options.identity);
        const XXH128_hash_t revision = XXH3_128bits(all.data(), all.size());
        facts.revision = fmt::format("{:016x}{:016x}", revision.high64, revision.low64);
        if (opened_->options.look) facts.look = opened_->options.look(upper);
    }

    /// Of the leaves, by their points.
    double meanSpacing() const {
        double sum = 0, points = 0;
        for (const StoredNode& stored : opened_->tree.nodes) {
            if (!stored.node.isLeaf()) continue;
            sum += double(stored.node.points) * stored.node.meanSpacing;
            points += double(stored.node.points);
        }
        return sum / points;
    }

    std::unique_ptr<Opened> opened_;
    const NativeScan& scan_;             // of its source
    std::vector<std::uint32_t> voxels_;  // the upper ones that were read
    std::uint64_t damaged_ = 0;          // those that were not
    Error firstDamage_{};
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> openNativeCloud(Expected<std::unique_ptr<VoxelSource>> source,
                                                           NativeCloudOptions options) {
    const std::string name = options.name.string();
    try {
        if (!source) return fail(source.error().code, name + ": " + source.error().message);
        auto cloud = Opening(std::move(*source), std::move(options)).run();
        if (!cloud) return fail(cloud.error().code, name + ": " + cloud.error().message);
        return cloud;
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, name + ": there is not enough memory for its octree");
    }
}

}  // namespace scancast
