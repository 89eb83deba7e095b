#include "server/catalog/counted_cloud.hpp"

#include <utility>

namespace scancast {

std::shared_ptr<const Cloud> counted(std::shared_ptr<const Cloud> cloud,
                                     const std::shared_ptr<BlockCache>& cache) {
    struct Counted {
        std::shared_ptr<const Cloud> cloud;
        std::shared_ptr<const void> bytes;
    };
    const std::uint64_t bytes = cloud->octree.bytesResident();
    // What views make of it is counted as well.
    if (!cloud->octree.nodes().empty())
        cloud->octree.store().derived().setStoreMaker(
            [cache = std::weak_ptr(cache)](
                std::shared_ptr<const CloudFile> file) -> std::shared_ptr<SampleStore> {
                const auto there = cache.lock();
                return there ? there->addDerived(std::move(file)) : nullptr;
            });
    const auto holder = std::make_shared<const Counted>(Counted{std::move(cloud), cache->reserve(bytes)});
    return {holder, holder->cloud.get()};
}

}  // namespace scancast
