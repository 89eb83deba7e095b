#include "renderer/cloud/copc/copc_cloud.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <glm/common.hpp>
#include <new>
#include <thread>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/copc/computing_turn.hpp"
#include "renderer/cloud/copc/copc_head.hpp"
#include "renderer/cloud/copc/gathered_points.hpp"
#include "renderer/cloud/copc/node_surfels.hpp"
#include "renderer/cloud/copc/upper_levels.hpp"
#include "renderer/cloud/copc/voxel_chunks.hpp"
#include "threads/guarded.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

constexpr std::size_t upperThreads = 4;
constexpr std::uint64_t usualMemory = 64 << 20;

/// All that is known when it is open; what refers to each other stays where it is.
struct Opened {
    std::unique_ptr<RandomReader> reader;
    std::shared_ptr<ChunkDecoders> decoders;
    NativeCloudOptions options;
    LasHeader las;
    LasColorDepth depth = LasColorDepth::Unknown;
    ChunkShape shape;
    CopcHierarchy hierarchy;
    AdditiveFrame frame;
    AdditiveTree tree;
    CloudFacts facts;
    std::vector<LasColumn> columns;  ///< of the records
    std::vector<RawPoints> upper;    ///< own points of upper voxels, by voxel; stay
};

class CopcFile final : public CloudFile {
  public:
    explicit CopcFile(std::unique_ptr<Opened> opened)
        : opened_(std::move(opened)),
          chunks_(*opened_->reader, *opened_->decoders, opened_->shape, opened_->hierarchy),
          gathered_(opened_->tree, opened_->hierarchy, opened_->frame, opened_->options.memory,
                    [this](std::uint32_t voxel) { return own(voxel); }) {}

    const fs::path& path() const override { return opened_->options.name; }
    std::uint64_t bytes() const override { return opened_->reader->size(); }
    bool isRemote() const override { return opened_->reader->isRemote(); }
    bool isAway() const override { return opened_->reader->isAway(); }
    bool isNative() const override { return true; }
    std::uint64_t ownMemory() const override {
        std::uint64_t bytes = opened_->hierarchy.voxels.size() * sizeof(CopcVoxel) +
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
                if (!upper(voxel)) chunks_.expect(voxel);
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
            if (voxel == noVoxel || opened_->hierarchy.voxels[voxel].points == 0) continue;
            const auto records = chunks_.records(voxel);
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
        const auto records = chunks_.records(voxel);
        if (!records) return passOn(records);
        auto points = rawPointsOf(*records, opened_->las, opened_->depth);
        if (!points) return passOn(std::move(points));
        return std::make_shared<const std::vector<RawPoint>>(std::move(*points));
    }

    Expected<std::optional<KeptPoint>> findRecord(std::span<const std::byte> records, const Sample& sample,
                                                  const NodeLattice& lattice) const {
        const auto points = rawPointsOf(records, opened_->las, opened_->depth);
        if (!points) return passOn(points);
        const auto gives = [&](const RawPoint& point) {
            const auto at = onLattice(point, lattice);
            return at && *at == std::array{sample.x, sample.y, sample.z} &&
                   point.intensity == sample.intensity && point.classification == sample.classification &&
                   point.color == std::array{sample.r, sample.g, sample.b};
        };
        const auto at = std::ranges::find_if(*points, gives);
        if (at == points->end()) return std::nullopt;
        const StepGrid grid = opened_->las.grid();
        KeptPoint kept{grid.at(at->at), grid.step, true, {}, {}, {}};
        const std::size_t stride = opened_->las.recordBytes;
        decodeLasColumns(records.subspan(std::size_t(at - points->begin()) * stride, stride), stride,
                         opened_->columns, kept.row);
        for (const LasColumn& column : opened_->columns) kept.columns.push_back(column.column);
        return kept;
    }

    tl::unexpected<Error> named(std::uint32_t node, const Error& error) const {
        const VoxelKey& key = opened_->tree.own[node].key;
        return fail(error.code, fmt::format("{}, voxel {}-{}-{}-{}: {}", path().string(), key.level,
                                            key.at[0], key.at[1], key.at[2], error.message));
    }

    const std::unique_ptr<Opened> opened_;
    const VoxelChunks chunks_;
    mutable GatheredPoints gathered_;
};

/// Errors without the file's name.
class Opening {
  public:
    Opening(std::unique_ptr<RandomReader> reader, std::shared_ptr<ChunkDecoders> decoders,
            NativeCloudOptions options)
        : opened_(std::make_unique<Opened>()) {
        opened_->reader = std::move(reader);
        opened_->decoders = std::move(decoders);
        opened_->options = std::move(options);
        if (!opened_->options.memory) opened_->options.memory = std::make_shared<GatheredMemory>(usualMemory);
    }

    Expected<std::shared_ptr<const CloudFile>> run() {
        const RandomReader& reader = *opened_->reader;
        auto head = readCopcHead(reader);
        if (!head) return passOn(std::move(head));
        auto hierarchy = readCopcHierarchy(reader, head->info);
        if (!hierarchy) return passOn(std::move(hierarchy));
        opened_->las = head->las.las();
        opened_->columns = head->las.allColumns();
        opened_->shape = head->shape;
        opened_->shape.owner = newSource();
        opened_->hierarchy = std::move(*hierarchy);
        auto records = upperRecords();
        if (!records) return passOn(std::move(records));
        for (const Bytes& chunk : *records) head->las.see(chunk);
        head->las.hasSeenAll();
        opened_->depth = depthOf(*records);
        if (auto ok = keepUpper(*records); !ok) return passOn(ok);
        opened_->frame = {head->info,
                          opened_->las.grid(),
                          {},
                          boundsOf(head->info),
                          rootSpacing(rootOf(*records), head->las, head->info)};
        LasReader las = std::move(head->las);
        las.setPoints(opened_->hierarchy.points);
        const ScanHeader scan = las.header();
        const auto upper =
            upperCloud(std::move(las), std::move(*records), opened_->options.title, opened_->options.surfels);
        if (!upper) return passOn(upper);
        opened_->frame.origin = (*upper)->origin;
        // Some headers have the bounds of another tile.
        auto& [low, high] = opened_->frame.bounds;
        low = glm::min(low, (*upper)->bounds[0]), high = glm::max(high, (*upper)->bounds[1]);
        auto tree = additiveTree(opened_->hierarchy, opened_->frame);
        if (!tree) return passOn(std::move(tree));
        opened_->tree = std::move(*tree);
        // A cube that is elsewhere than the points would damage every block.
        if (!opened_->upper.empty() && opened_->upper.front())
            if (const auto root = samplesOf(*opened_->upper.front(), opened_->tree.own.front().lattice);
                !root)
                return passOn(root);
        fillFacts(*upper, scan, head->digest);
        return std::make_shared<const CopcFile>(std::move(opened_));
    }

  private:
    /// The header's where they can be meant; else the cube.
    std::array<glm::dvec3, 2> boundsOf(const CopcInfo& info) const {
        const glm::dvec3 low = info.center - info.halfSize, high = info.center + info.halfSize;
        const auto [first, last] = opened_->las.bounds;
        const double more = info.halfSize / 4;
        for (int a = 0; a < 3; ++a)
            if (!(first[a] <= last[a] && first[a] >= low[a] - more && last[a] <= high[a] + more))
                return {low, high};
        return {first, last};
    }

    /// Fetched all at once, and decoded by as many as there are.
    Expected<std::vector<Bytes>> upperRecords() {
        voxels_ = upperVoxels(opened_->hierarchy, opened_->options.upperPoints);
        const VoxelChunks chunks(*opened_->reader, *opened_->decoders, opened_->shape, opened_->hierarchy);
        for (const std::uint32_t voxel : voxels_) chunks.expect(voxel);
        std::vector<Expected<Bytes>> got(voxels_.size());
        std::atomic<std::size_t> next = 0;
        const auto work = [&] {
            for (std::size_t i = next++; i < got.size(); i = next++)
                got[i] = guarded("Reading a voxel", [&] { return chunks.records(voxels_[i]); });
        };
        {
            // Not those that draw: these wait, for the network and for decoders.
            std::vector<std::jthread> threads;
            const std::size_t most = std::min(upperThreads, got.size());
            for (std::size_t i = 1; i < most; ++i) threads.emplace_back(work);
            work();
        }
        std::vector<Bytes> records;
        for (auto& one : got) {
            if (!one) return passOn(std::move(one));
            records.push_back(std::move(*one));
        }
        return records;
    }

    LasColorDepth depthOf(const std::vector<Bytes>& records) const {
        LasColorDepth depth = LasColorDepth::Unknown;
        for (const Bytes& chunk : records) depth = std::max(depth, colorDepth(chunk, opened_->las));
        return depth;
    }

    Expected<void> keepUpper(const std::vector<Bytes>& records) {
        if (!voxels_.empty()) opened_->upper.resize(voxels_.back() + 1);
        for (std::size_t i = 0; i < voxels_.size(); ++i) {
            auto points = rawPointsOf(records[i], opened_->las, opened_->depth);
            if (!points) return passOn(std::move(points));
            opened_->upper[voxels_[i]] = std::make_shared<const std::vector<RawPoint>>(std::move(*points));
        }
        return {};
    }

    std::span<const std::byte> rootOf(const std::vector<Bytes>& records) const {
        if (voxels_.empty() || voxels_.front() != 0) return {};
        return records.front();
    }

    void fillFacts(const std::shared_ptr<const Cloud>& upper, const ScanHeader& scan, std::uint64_t digest) {
        CloudFacts& facts = opened_->facts;
        facts = *upper;
        const CopcHierarchy& hierarchy = opened_->hierarchy;
        const std::uint64_t seen = upper->points;
        facts.title = opened_->options.title;
        facts.format = fmt::format("COPC 1.0, LAS 1.{}, point format {}", opened_->las.minorVersion,
                                   opened_->las.pointFormat);
        facts.points = hierarchy.points;
        facts.bounds = opened_->frame.bounds;
        facts.crsWkt = scan.crsWkt;
        facts.crsEpsg = scan.crsEpsg;
        if (const auto& crs = opened_->options.crs) facts.crsWkt = crs->wkt, facts.crsEpsg = crs->epsg;
        facts.mirrors = opened_->options.mirrors;
        if (hierarchy.points != opened_->las.points)
            facts.notes.push_back(fmt::format("its header promises {} points, and its octree has {}",
                                              grouped(opened_->las.points), grouped(hierarchy.points)));
        facts.grid = ScanGrid{opened_->las.grid().origin, opened_->las.grid().step};
        facts.spacing = meanSpacing();
        // What each node finds out by itself has no side; there is nothing beside it.
        facts.oriented = false;
        facts.sides.reset();
        facts.companions.clear();
        if (seen < hierarchy.points)
            facts.notes.push_back(fmt::format(
                "it is shown as it is, without ingest: ranges, classes and colours are those of {} points "
                "of its upper levels",
                grouped(seen)));
        std::string all = fmt::format("{}\n{:016x} {:016x} {}\n{}", upper->revision, digest, hierarchy.digest,
                                      opened_->options.surfels, opened_->options.identity);
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
    std::vector<std::uint32_t> voxels_;  // the upper ones
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> openCopc(std::unique_ptr<RandomReader> reader,
                                                    std::shared_ptr<ChunkDecoders> decoders,
                                                    NativeCloudOptions options) {
    const std::string name = options.name.string();
    try {
        auto file = Opening(std::move(reader), std::move(decoders), std::move(options)).run();
        if (!file) return fail(file.error().code, name + ": " + file.error().message);
        return file;
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, name + ": there is not enough memory for its octree");
    }
}

}  // namespace scancast
