#include "renderer/cloud/derived_octrees.hpp"

#include <algorithm>

#include "renderer/cloud/octree.hpp"

namespace scancast {

// With the lock held.
std::shared_ptr<const Octree> DerivedOctrees::use(const std::string& words) {
    const auto found = std::ranges::find(kept_, words, &Kept::first);
    if (found == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, found);
    return found->second;
}

std::shared_ptr<const Octree> DerivedOctrees::find(const std::string& words) {
    const std::lock_guard lock(guard_);
    return use(words);
}

std::shared_ptr<const Octree> DerivedOctrees::keep(const std::string& words,
                                                   std::shared_ptr<const Octree> octree) {
    std::list<Kept> forgotten;  // goes when the lock has been given back
    const std::lock_guard lock(guard_);
    if (auto known = use(words)) return known;
    kept_.emplace_front(words, std::move(octree));
    if (kept_.size() > mostKept) forgotten.splice(forgotten.begin(), kept_, std::prev(kept_.end()));
    return kept_.front().second;
}

std::shared_ptr<SampleStore> DerivedOctrees::storeFor(std::shared_ptr<const CloudFile> file) const {
    return maker_ ? maker_(std::move(file)) : nullptr;
}

}  // namespace scancast
