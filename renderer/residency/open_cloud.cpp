#include "renderer/residency/open_cloud.hpp"

#include <algorithm>
#include <string>

namespace scancast {
namespace {

/// Blocks of clouds that ingest wrote are smaller by far.
constexpr std::uint64_t alwaysRead = 32 << 20;

std::string megabytes(std::uint64_t bytes) {
    return std::to_string(bytes / 1'000'000) + " MB";
}

/// A block is read as a whole, whatever few bytes it was packed into, and a picture may hold three quarters of the limit.
Expected<void> checkBlocks(const CloudFile& file, std::uint64_t limit) {
    const std::uint64_t most = std::max(limit / 4 * 3, alwaysRead);
    const auto nodes = file.nodes();
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const std::uint64_t samples = nodes[node].node.sampleCount;
        const std::uint64_t bytes = samples * (sizeof(Sample) + sizeof(BesideWord));
        if (bytes <= most) continue;
        return fail(ErrorCode::ResourceLimit, file.path().filename().string() + ": block " +
                                                  std::to_string(node) + " holds " + std::to_string(samples) +
                                                  " samples, which take " + megabytes(bytes) +
                                                  " of memory, and there may be " + megabytes(most) +
                                                  " in one. A larger --memory-limit would let it in; "
                                                  "ingesting the scan anew makes smaller blocks.");
    }
    return {};
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> openCloud(std::shared_ptr<const CloudFile> file,
                                                 const std::shared_ptr<BlockCache>& cache) {
    if (auto ok = checkBlocks(*file, cache->stats().limit); !ok) return passOn(ok);
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
