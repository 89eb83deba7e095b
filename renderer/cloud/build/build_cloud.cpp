#include "renderer/cloud/build/build_cloud.hpp"

#include <spdlog/fmt/fmt.h>

#include <new>
#include <thread>

#include "files/machine.hpp"
#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/revision.hpp"

namespace scancast {

namespace {

Expected<std::shared_ptr<const Cloud>> build(PointSource& source, const BuildOptions& options,
                                             const ProgressSink& progress) {
    Workspace workspace(Workspace::unlimited, {});
    const int lanes = coresOf(options.threads);
    auto built = buildFrom(
        source, options.shape,
        {.workspace = workspace, .file = nullptr, .threads = options.threads, .lanes = lanes}, progress, {});
    if (!built) return passOn(built);
    auto cloud = std::make_shared<Cloud>();
    static_cast<CloudFacts&>(*cloud) = std::move(built->facts);
    cloud->title = options.title;
    cloud->mirrors = options.mirrors;
    cloud->revision = revisionOf(*cloud, built->octree);
    std::vector<Node> nodes;
    nodes.reserve(built->octree.nodes.size());
    for (const StoredNode& n : built->octree.nodes) nodes.push_back(n.node);
    cloud->octree =
        Octree(std::move(nodes), std::move(built->octree.samples), std::move(built->octree.beside));
    return cloud;
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> buildCloud(PointSource& source, const BuildOptions& options,
                                                  const ProgressSink& progress) {
    try {
        return build(source, options, progress);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit,
                    "There is not enough memory for this scan; about 60 bytes a point are needed while it is "
                    "loaded.");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The octree could not be built: {}.", e.what()));
    }
}

}  // namespace scancast
