#include "renderer/cloud/octree.hpp"

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

}  // namespace scancast
