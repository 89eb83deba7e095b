#include "renderer/residency/open_cloud.hpp"

#include <array>
#include <fstream>

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
    auto file = CloudFile::open(path);
    if (!file) return tl::unexpected(std::move(file.error()));
    return openCloud(std::move(*file), cache);
}

bool isCloudFileAt(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::array<char, 64> start{};
    in.read(start.data(), start.size());
    const auto count = static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0));
    return isCloudFile(std::as_bytes(std::span(start.data(), count)));
}

}  // namespace scancast
