#include "renderer/residency/open_cloud.hpp"

namespace scancast {

Expected<std::shared_ptr<const Cloud>> openCloud(std::shared_ptr<const CloudFile> file,
                                                 const std::shared_ptr<BlockCache>& cache) {
    auto cloud = std::make_shared<Cloud>();
    static_cast<CloudFacts&>(*cloud) = file->facts();
    std::vector<Node> nodes;
    nodes.reserve(file->nodes().size());
    for (const StoredNode& stored : file->nodes()) nodes.push_back(stored.node);
    const bool empty = nodes.empty();
    auto store = cache->add(std::move(file));
    // Then there is always something to draw; who looks at a damaged root sees finer nodes, once they are
    // there.
    if (!empty) (void)store->load(0);
    cloud->octree = Octree(std::move(nodes), std::move(store));
    return cloud;
}

Expected<std::shared_ptr<const Cloud>> openCloud(const std::filesystem::path& path,
                                                 const std::shared_ptr<BlockCache>& cache) {
    auto file = InputFile::open(path);
    if (!file) return passOn(std::move(file));
    return openCloud(std::move(*file), cache);
}

Expected<std::shared_ptr<const Cloud>> openCloud(InputFile file, const std::shared_ptr<BlockCache>& cache) {
    auto opened = CloudFile::open(std::move(file));
    if (!opened) return passOn(std::move(opened));
    return openCloud(std::move(*opened), cache);
}

bool isCloudFileAt(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    return file && isCloudFile(*file);
}

}  // namespace scancast
