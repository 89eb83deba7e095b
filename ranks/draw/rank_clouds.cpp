#include "ranks/draw/rank_clouds.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "renderer/residency/node_runs.hpp"
#include "renderer/residency/open_cloud.hpp"

namespace scancast {

// ---- rank 0

std::shared_ptr<SampleStore> SharedClouds::add(std::shared_ptr<const CloudFile> file) {
    std::error_code unknown;
    const auto path = std::filesystem::absolute(file->path(), unknown);
    if (!file->facts().look || unknown) {
        spdlog::warn(
            "{}: no look is kept in it, so rank 0 draws it alone; scancast look {} decides it once and keeps "
            "it",
            file->path().filename().string(), file->path().string());
        return cache_->add(std::move(file));
    }
    {
        const std::scoped_lock lock(mutex_);
        paths_[file->facts().revision] = path.string();
    }
    return sharedStore(cache_->add(std::move(file)), share_);
}

void SharedClouds::know(const Cloud& cloud) {
    const std::scoped_lock lock(mutex_);
    if (paths_.contains(cloud.revision)) revisions_[cloud.octree.source()] = cloud.revision;
}

std::optional<CloudPlace> SharedClouds::placeOf(std::uint64_t source) const {
    const std::scoped_lock lock(mutex_);
    const auto revision = revisions_.find(source);
    if (revision == revisions_.end()) return std::nullopt;
    return CloudPlace{paths_.at(revision->second), revision->second};
}

// ---- the others

Expected<std::shared_ptr<const Cloud>> OpenedClouds::find(const CloudPlace& place) {
    if (const auto known = clouds_.find(place.path);
        known != clouds_.end() && known->second->revision == place.revision)
        return known->second;
    auto opened = openCloud(place.path, cache_);
    if (!opened) return opened;
    if ((*opened)->revision != place.revision)
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} is not the same file on all ranks: its revisions are {} and {}.",
                                place.path, place.revision, (*opened)->revision));
    clouds_[place.path] = *opened;
    return opened;
}

Expected<void> OpenedClouds::provide(UnpackedDrawing& drawing) {
    const auto cloud = find(drawing.cloud);
    if (!cloud) return passOn(cloud);
    const Octree& octree = (*cloud)->octree;
    if (auto ok = drawing.findNodes(octree); !ok) return ok;
    std::vector<std::uint32_t> own;
    for (const CutView* const view : drawing.allCuts())
        for (const CutRun& run : view->cut.runs)
            if (share_.has(run.nodeIndex)) own.push_back(run.nodeIndex);
    NodeRuns runs(octree);
    if (auto ok = runs.load(own, {}); !ok) return ok;
    for (CutView* const view : drawing.allCuts()) {
        for (CutRun& run : view->cut.runs) {
            if (!share_.has(run.nodeIndex)) continue;
            if (!runs.has(run.nodeIndex))
                return fail(
                    ErrorCode::Malformed,
                    fmt::format("{}: a rank cannot read block {}; scancast info --verify tells which blocks "
                                "are damaged.",
                                drawing.cloud.path, run.nodeIndex));
            const SampleRun& samples = runs.run(run.nodeIndex);
            run.samples = samples.samples;
            run.limits = samples.limits;
            if (view->cut.beside) run.beside = samples.beside;
            if (samples.keep) view->cut.keep.push_back(samples.keep);
        }
    }
    return {};
}

}  // namespace scancast
