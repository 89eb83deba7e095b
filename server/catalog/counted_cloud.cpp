#include "server/catalog/counted_cloud.hpp"

#include <utility>

namespace scancast {

std::shared_ptr<const Cloud> counted(std::shared_ptr<const Cloud> cloud, BlockCache& cache) {
    struct Counted {
        std::shared_ptr<const Cloud> cloud;
        std::shared_ptr<const void> bytes;
    };
    const std::uint64_t bytes = cloud->octree.bytesResident();
    const auto holder = std::make_shared<const Counted>(Counted{std::move(cloud), cache.reserve(bytes)});
    return {holder, holder->cloud.get()};
}

}  // namespace scancast
