#include "renderer/residency/node_share.hpp"

#include <utility>
#include <vector>

namespace scancast {
namespace {

/// Of many nodes, those that are the share's, and where their answers belong.
struct OwnNodes {
    std::vector<std::uint32_t> nodes;
    std::vector<std::size_t> places;

    OwnNodes(std::span<const std::uint32_t> all, NodeShare share) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!share.has(all[i])) continue;
            nodes.push_back(all[i]);
            places.push_back(i);
        }
    }
};

class SharedStore final : public SampleStore {
  public:
    SharedStore(std::shared_ptr<SampleStore> whole, NodeShare share, std::shared_ptr<const CloudPlace> place)
        : whole_(std::move(whole)), share_(share), place_(std::move(place)) {}

    const std::shared_ptr<const CloudPlace>& place() const { return place_; }

    std::optional<SampleRun> find(std::uint32_t node) override {
        return share_.has(node) ? whole_->find(node) : SampleRun{};
    }
    std::vector<std::optional<SampleRun>> findAll(std::span<const std::uint32_t> nodes) override {
        const OwnNodes own(nodes, share_);
        std::vector<std::optional<SampleRun>> all(nodes.size(), SampleRun{});
        auto found = whole_->findAll(own.nodes);
        for (std::size_t i = 0; i < found.size(); ++i) all[own.places[i]] = std::move(found[i]);
        return all;
    }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override {
        return whole_->load(node, std::move(stop));
    }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override {
        const OwnNodes own(nodes, share_);
        std::vector<Expected<SampleRun>> all(nodes.size(), SampleRun{});
        auto loaded = whole_->loadAll(own.nodes, std::move(stop));
        for (std::size_t i = 0; i < loaded.size(); ++i) all[own.places[i]] = std::move(loaded[i]);
        return all;
    }
    void request(std::uint64_t requester, std::vector<BlockRequest> requests) override {
        std::erase_if(requests, [this](const BlockRequest& r) { return !share_.has(r.node); });
        whole_->request(requester, std::move(requests));
    }
    bool whole() const override { return whole_->whole(); }
    bool damaged(std::uint32_t node) const override { return share_.has(node) && whole_->damaged(node); }
    bool isAway() const override { return whole_->isAway(); }
    std::uint64_t capacity() const override { return whole_->capacity() * share_.of; }
    std::uint64_t bytesResident() const override { return whole_->bytesResident(); }
    std::shared_ptr<const CloudFile> cloudFile() const override { return whole_->cloudFile(); }

  private:
    const std::shared_ptr<SampleStore> whole_;
    const NodeShare share_;
    const std::shared_ptr<const CloudPlace> place_;
};

}  // namespace

std::shared_ptr<SampleStore> sharedStore(std::shared_ptr<SampleStore> whole, NodeShare share,
                                         std::shared_ptr<const CloudPlace> place) {
    return std::make_shared<SharedStore>(std::move(whole), share, std::move(place));
}

std::shared_ptr<const CloudPlace> placeOfShared(const SampleStore& store) {
    const auto* const shared = dynamic_cast<const SharedStore*>(&store);
    return shared != nullptr ? shared->place() : nullptr;
}

}  // namespace scancast
