#include "ranks/ingest/rank_ingest.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "files/machine.hpp"
#include "ranks/ingest/chunk_owners.hpp"
#include "ranks/ingest/gathered_file.hpp"
#include "ranks/ingest/joined_counts.hpp"
#include "ranks/ingest/point_rounds.hpp"
#include "ranks/ingest/shared_scans.hpp"
#include "ranks/ingest/shared_sides.hpp"
#include "ranks/ingest/shared_tree.hpp"
#include "renderer/cloud/build/chunks/staged_portions.hpp"
#include "renderer/cloud/build/finish.hpp"
#include "renderer/cloud/build/plan/build_plan.hpp"
#include "renderer/cloud/build/plan/finish_file.hpp"
#include "renderer/cloud/build/plan/ingest_room.hpp"

namespace scancast {

namespace {

/// What a rank may hold of others' in a round: in all, three times as much (point_rounds.hpp).
constexpr std::uint64_t mostOfRound = std::uint64_t(64) << 20, partOfRound = 48, roundsHeld = 3;

struct RankMemory {
    MemoryShares shares;
    std::uint64_t round = 0;
};

/// Rounds as the rank with the least memory can have them.
Expected<RankMemory> shareMemoryOfRank(std::uint64_t limit, const IngestOptions& options,
                                       const RankRoom& room) {
    RankMemory memory{.shares = shareMemory(limit, options.threads, options.shape),
                      .round = std::min({mostOfRound, limit / partOfRound, room.mostInRound})};
    if (auto ok = room.ranks.min(std::span(&memory.round, 1)); !ok) return passOn(ok);
    std::uint64_t& waiting = memory.shares.workspace;
    if (room.ranks.size() > 1) waiting -= std::min(waiting, roundsHeld * memory.round);
    waiting = std::min(waiting, room.mostWaiting);
    return memory;
}

/// Rank 0's; elsewhere null. All ranks hear why not.
Expected<std::unique_ptr<CloudFileWriter>> createFile(const IngestOptions& options,
                                                      const Communicator& ranks) {
    Expected<std::unique_ptr<CloudFileWriter>> file;
    if (ranks.isFirst()) file = CloudFileWriter::create(options.output, options.readers);
    return ranks.agree(std::move(file));
}

class RankIngest {
  public:
    /// `file`: rank 0's, else null.
    RankIngest(const IngestOptions& options, const RankRoom& room, const RankMemory& memory,
               CloudFileWriter* file, const ProgressSink& progress, const std::stop_token& stop)
        : options_(options),
          ranks_(room.ranks),
          alarm_(room.alarm),
          memory_(memory),
          file_(file),
          progress_(progress),
          stop_(stop),
          workspace_(memory.shares.workspace, scratchFolder(options)),
          shelf_(workspace_) {}

    Expected<IngestReport> run(SharedScans scans) {
        if (auto ok = read(scans); !ok) return passOn(ok);
        Expected<BuiltOctree> octree;
        tbb::task_arena arena(options_.threads);
        arena.execute([&] { octree = build(); });
        if (!octree) return passOn(octree);
        Expected<IngestReport> report = IngestReport();
        if (file_) {
            BuiltCloud cloud{.facts = std::move(plan_.facts), .octree = std::move(*octree)};
            completeFacts(cloud.facts, plan_.input, cloud.octree);
            report = finishFile(std::move(cloud), options_, *file_, progress_, stop_);
        }
        const auto all = agreed(report);
        std::array<std::uint64_t, 1> scratch{workspace_.mostOnDisk()};
        Expected<void> summed;
        if (all)
            summed = ranks_.sum(scratch);
        else
            summed = passOn(all);
        if (report) report->scratchBytes = scratch[0];
        // What has its name is there, whatever others have met since.
        if (file_ && report) return report;
        if (!summed) return passOn(summed);
        return report;
    }

  private:
    /// Others hear at once that they may stop, and at the end of the step why.
    template <class T>
    Expected<T> agreed(Expected<T> mine) {
        if (!mine) alarm_.ring();
        return ranks_.agree(std::move(mine));
    }

    Expected<void> read(SharedScans& scans) {
        header_ = scans.source().header();
        const bool sights = wantsSights(header_, options_.shape);
        ProgressMeter reading(progress_, "reading", scans.pointsToRead());
        auto staged = agreed(stagePart(scans.source(), workspace_, reading, stop_, sights));
        if (!staged) return passOn(staged);
        reading.finish();
        scan_ = std::move(*staged);
        if (auto ok = agreed(scans.hearOthers(ranks_)); !ok) return ok;
        takeTold(scans.source(), scan_);
        header_.scannerOrigin = scans.scannerOrigin();  // known for certain only now
        if (auto ok = joinStaged(scan_, ranks_); !ok) return ok;
        if (auto ok = agreed(settleStaged(scan_)); !ok) return ok;
        auto plan = agreed(planBuild(scan_, header_, options_.shape));
        if (!plan) return passOn(plan);
        plan_ = std::move(*plan);
        return {};
    }

    /// The octree, at rank 0; elsewhere nothing.
    Expected<BuiltOctree> build() {
        const OctreeInput& input = plan_.input;
        BuildNode root;
        DividedTop top;
        auto chunks = divideTogether(root, top);
        if (!chunks) return passOn(chunks);
        ShelfParts parts;
        const auto sides = [&](const Expected<void>& grown, std::vector<Facet>& facets,
                               std::span<const PatchCount> patches, std::span<const Border> borders) {
            if (!grown) alarm_.ring();
            parts.held = shelf_.bytes();
            return decideTogether(grown, facets, patches, borders, input.upIsZ, ranks_);
        };
        const auto sure = agreed(growTree(std::move(*chunks), input, memory_.shares.lanes, workspace_,
                                          &shelf_, sides, progress_, stop_));
        if (!sure) return passOn(sure);
        parts.leaves = shelf_.bytes();
        std::array<std::uint64_t, 2> sureness{sure->points, sure->sure};
        if (auto ok = ranks_.sum(sureness); !ok) return passOn(ok);

        if (auto ok = shareTree(top, input, workspace_, ranks_); !ok) return passOn(ok);
        NumberedTree tree(root, top);
        const std::vector<BuildNode*> inner = innerNodes(root);
        ValueSketch curvatures;
        if (auto ok = finishOwn(tree, root, inner, curvatures); !ok) return passOn(ok);
        const GatheringRoom room{.ranks = ranks_, .alarm = alarm_, .progress = progress_, .stop = stop_};
        if (auto ok = gatherFile(tree, inner, shelf_, parts, file_, room); !ok) return passOn(ok);
        if (!file_) return BuiltOctree();
        BuiltOctree octree = numberTree(root, input, true, curvatures);
        octree.sure = SureCount{sureness[0], sureness[1]}.share();
        return octree;
    }

    /// This rank's chunks, each with its place in the tree.
    Expected<std::vector<Chunk>> divideTogether(BuildNode& root, DividedTop& top) {
        const Grid& grid = plan_.input.grid;
        const ChunkOptions chunking{.chunkPoints = options_.shape.chunkPoints,
                                    .rowBytes = plan_.input.rowBytes,
                                    .halo = options_.shape.surfels};
        StagedPortions portions(scan_, header_, grid);
        auto counted = agreed(countPoints(portions, plan_.box, stop_));
        if (!counted) return passOn(counted);
        auto cells = joinCounts(std::move(*counted), plan_.box, ranks_);
        if (!cells) return passOn(cells);
        const std::uint64_t most = mostChunkPoints(plan_.box, scan_.points, chunking);
        const ChunkLayout layout =
            layOutChunks(cells->frame, std::move(cells->cells), grid, most, chunking.halo);
        const ChunkOwners owners(layout, ranks_.size());
        const std::vector<BuildNode*> places = growTop(layout.root, root);
        top = divideTop(layout.root, root, owners);

        ProgressMeter sorting(progress_, "sorting", pointsOf(scan_));
        auto chunks = pointsToOwners(
            portions, layout, owners, chunking.rowBytes,
            {.ranks = ranks_, .alarm = alarm_, .workspace = workspace_, .bytes = memory_.round}, sorting,
            stop_);
        if (!chunks) return chunks;
        sorting.finish();
        scan_.batches.clear();
        for (std::size_t i = 0; i < chunks->size(); ++i)
            (*chunks)[i].root = places[owners.firstOf(ranks_.rank()) + i];
        return agreed(divideCrowds(std::move(*chunks), most, grid, chunking, workspace_, sorting, stop_));
    }

    static std::uint64_t pointsOf(const StagedScan& scan) {
        std::uint64_t points = 0;
        for (const StagedBatch& batch : scan.batches) points += batch.points;
        return points;
    }

    /// Inner nodes of which this rank has the samples.
    Expected<void> finishOwn(NumberedTree& tree, BuildNode& root, std::span<BuildNode* const> inner,
                             ValueSketch& curvatures) {
        const OctreeInput& input = plan_.input;
        std::vector<BuildNode*> own;
        for (BuildNode* node : inner)
            if (tree.ownerOf(tree.numberOf(*node)) == ranks_.rank()) own.push_back(node);
        if (input.shape.surfels)
            if (auto ok = fetchNeighbours(tree, own, shelf_, workspace_, memory_.round, ranks_); !ok)
                return ok;
        Expected<void> done = finishInnerNodes(own, root, input, &shelf_, curvatures, progress_, stop_);
        if (done && root.isLeaf() && tree.ownerOf(0) == ranks_.rank())
            done = addLeafCurvatures(root, input, &shelf_, curvatures);
        if (auto ok = agreed(std::move(done)); !ok) return ok;
        return joinSketch(curvatures, ranks_);
    }

    const IngestOptions& options_;
    const Communicator& ranks_;
    Alarm& alarm_;
    const RankMemory memory_;
    CloudFileWriter* const file_;
    const ProgressSink& progress_;
    const std::stop_token& stop_;
    Workspace workspace_;
    BlockShelf shelf_;
    ScanHeader header_;
    StagedScan scan_;
    BuildPlan plan_;
};

/// Refuses before reading what could not be finished: each rank its own share of what waits, and rank 0 the file.
Expected<void> checkRoom(const PointSource& all, std::uint64_t ownPoints, const IngestOptions& options,
                         const RankRoom& room) {
    if (!all.header().points) return {};
    ScanHeader own = all.header();
    own.points = ownPoints;
    const auto total = diskNeeds(all.header(), options), share = diskNeeds(own, options);
    const std::uint64_t photos = options.photos ? bytesOf(all.photos()) : 0;
    // Finished blocks wait beside points that are not yet built, on every rank of this machine.
    DiskNeeds needs{
        .file = 0,
        .scratch = (share->scratch > 0 ? share->scratch + share->file : 0) * unsigned(room.onThisMachine)};
    if (room.ranks.isFirst()) {
        needs.file = total->file + photos;
        needs.scratch += photos;
    }
    return checkDisk(needs, room.ranks.isFirst() ? folderOf(options.output) : scratchFolder(options),
                     scratchFolder(options));
}

Expected<IngestReport> begin(std::vector<std::unique_ptr<PointSource>> sources, const IngestOptions& options,
                             const RankRoom& room, const ProgressSink& progress,
                             const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    const Communicator& ranks = room.ranks;
    auto limit = ranks.agree(memoryLimit(options));
    if (!limit) return passOn(limit);
    auto scans = SharedScans::create(std::move(sources), options, ranks);
    if (!scans) return passOn(scans);
    if (auto ok = ranks.agree(checkRoom(scans->source(), scans->pointsToRead(), options, room)); !ok)
        return passOn(ok);
    const auto memory = shareMemoryOfRank(*limit, options, room);
    if (!memory) return passOn(memory);
    const auto file = createFile(options, ranks);
    if (!file) return passOn(file);
    // Who is told to end has a second: mpirun kills what has not ended by then.
    const std::stop_callback withdrawing(stop, [&] {
        if (*file) (*file)->withdraw();
    });
    RankIngest ingest(options, room, *memory, file->get(), progress, stop);
    auto report = ingest.run(std::move(*scans));
    if (report)
        report->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace

IngestOptions withOwnPart(IngestOptions options, int onThisMachine) {
    if (options.threads == 0) options.threads = std::max(1, machineCores() / onThisMachine);
    if (options.memoryLimit == 0) options.memoryLimit = machineMemory() / 2 / unsigned(onThisMachine);
    return options;
}

Expected<IngestReport> ingestTogether(std::vector<std::unique_ptr<PointSource>> sources,
                                      const IngestOptions& options, const RankRoom& room,
                                      const ProgressSink& progress, std::stop_token stop) {
    return begin(std::move(sources), options, room, progress, stop);
}

}  // namespace scancast
