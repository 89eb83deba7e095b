#include "renderer/cloud/build/cloud_builder.hpp"

#include <tbb/task_arena.h>

#include "renderer/cloud/build/chunks/staged_portions.hpp"
#include "renderer/cloud/build/plan/build_plan.hpp"

namespace scancast {

Expected<BuiltCloud> buildFrom(PointSource& source, const OctreeShape& shape, const BuildRoom& room,
                               const ProgressSink& progress, const std::stop_token& stop) {
    ScanHeader header = source.header();
    ProgressMeter reading(progress, "reading", header.points.value_or(0));
    auto scan = stage(source, room.workspace, reading, stop, wantsSights(header, shape));
    if (!scan) return passOn(scan);
    header.scannerOrigin =
        source.header().scannerOrigin;  // known for certain only now: a second scan may have come
    auto plan = planBuild(*scan, header, shape);
    if (!plan) return passOn(plan);

    const OctreeInput& input = plan->input;
    BuildNode root;
    Expected<BuiltOctree> octree;
    tbb::task_arena arena(room.threads > 0 ? room.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        StagedPortions portions(*scan, header, input.grid);
        ProgressMeter sorting(progress, "sorting", scan->points);
        const ChunkOptions chunking{
            .chunkPoints = shape.chunkPoints, .rowBytes = input.rowBytes, .halo = shape.surfels};
        auto chunks = divide(portions, scan->points, plan->box, root, input.grid, chunking, room.workspace,
                             sorting, stop);
        if (!chunks) {
            octree = tl::unexpected(chunks.error());
            return;
        }
        sorting.finish();
        scan->batches.clear();
        octree = buildOctree(root, std::move(*chunks), input, room.lanes, room.workspace, room.file, progress,
                             stop);
    });
    if (!octree) return passOn(octree);
    BuiltCloud cloud{.facts = std::move(plan->facts), .octree = std::move(*octree)};
    completeFacts(cloud.facts, input, cloud.octree);
    return cloud;
}

}  // namespace scancast
