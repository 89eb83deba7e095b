#include "renderer/cloud/octree.hpp"

#include <algorithm>
#include <atomic>

namespace scancast {

namespace {

std::vector<std::uint64_t> firstOfRuns(const std::vector<Node>& nodes, std::uint64_t end) {
    std::vector<std::uint64_t> first;
    first.reserve(nodes.size() + 1);
    for (const Node& n : nodes) first.push_back(n.firstSample);
    first.push_back(end);
    return first;
}

/// Breadth first, the first child of all comes right behind the roots.
std::uint32_t rootsOf(const std::vector<Node>& nodes) {
    for (const Node& n : nodes)
        if (!n.isLeaf()) return n.firstChild;
    return static_cast<std::uint32_t>(nodes.size());
}

}  // namespace

std::uint64_t newSource() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

Octree::Octree(std::vector<Node> nodes, std::vector<Sample> samples, std::vector<BesideWord> beside)
    : nodes_(std::move(nodes)), sampleCount_(samples.size()), source_(newSource()), roots_(rootsOf(nodes_)) {
    auto first = firstOfRuns(nodes_, samples.size());
    store_ = memoryStore(std::move(samples), std::move(first), std::move(beside));
}

Octree::Octree(std::vector<Node> nodes, std::shared_ptr<SampleStore> store, std::uint64_t source)
    : nodes_(std::move(nodes)),
      store_(std::move(store)),
      source_(source > 0 ? source : newSource()),
      roots_(rootsOf(nodes_)) {
    for (const Node& n : nodes_) sampleCount_ += n.sampleCount;
}

std::uint64_t Octree::bytesResident() const {
    return nodes_.size() * sizeof(Node) + (store_ ? store_->bytesResident() : 0);
}

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
