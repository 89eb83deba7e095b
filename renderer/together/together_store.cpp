#include "renderer/together/together_store.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

namespace scancast {
namespace {

/// Whose requests hold while somebody waits for blocks of several clouds: nobody else's, and not a session's.
std::uint64_t newWaiter() {
    static std::atomic<std::uint64_t> last{std::uint64_t(1) << 63};
    return ++last;
}

/// Of nodes that are asked for together, those of one store.
struct PartOfNodes {
    std::vector<std::uint32_t> nodes;  ///< as the store knows them
    std::vector<std::size_t> places;   ///< in what was asked for
};

class TogetherStore final : public SampleStore {
  public:
    explicit TogetherStore(std::shared_ptr<const Together> together) : together_(std::move(together)) {
        // A cloud that is shown twice has one store: requests must come to it as one.
        for (const auto& store : together_->stores) {
            const auto known = std::ranges::find(stores_, store);
            of_.push_back(std::size_t(known - stores_.begin()));
            if (store && known == stores_.end()) stores_.push_back(store);
        }
    }

    std::optional<SampleRun> find(std::uint32_t node) override { return storeOf(node).find(nodeOf(node)); }
    std::vector<std::optional<SampleRun>> findAll(std::span<const std::uint32_t> nodes) override {
        std::vector<std::optional<SampleRun>> all(nodes.size());
        const auto parts = partsOf(nodes);
        for (std::size_t s = 0; s < parts.size(); ++s) {
            if (parts[s].nodes.empty()) continue;
            auto found = stores_[s]->findAll(parts[s].nodes);
            for (std::size_t i = 0; i < found.size(); ++i) all[parts[s].places[i]] = std::move(found[i]);
        }
        return all;
    }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override {
        return storeOf(node).load(nodeOf(node), std::move(stop));
    }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override {
        const auto parts = partsOf(nodes);
        const Ahead ahead(*this, parts);
        std::vector<Expected<SampleRun>> all(nodes.size(), SampleRun{});
        for (std::size_t s = 0; s < parts.size(); ++s) {
            if (parts[s].nodes.empty()) continue;
            auto loaded = stores_[s]->loadAll(parts[s].nodes, stop);
            for (std::size_t i = 0; i < loaded.size(); ++i) all[parts[s].places[i]] = std::move(loaded[i]);
        }
        return all;
    }
    /// Each store hears of it, for its earlier requests are moot.
    void request(std::uint64_t requester, std::vector<BlockRequest> requests) override {
        std::vector<std::vector<BlockRequest>> parts(stores_.size());
        for (const BlockRequest& request : requests)
            parts[storeIndex(request.node)].push_back({nodeOf(request.node), request.urgency});
        for (std::size_t s = 0; s < stores_.size(); ++s) stores_[s]->request(requester, std::move(parts[s]));
    }
    bool whole() const override {
        return std::ranges::all_of(stores_, [](const auto& store) { return store->whole(); });
    }
    bool damaged(std::uint32_t node) const override { return storeOf(node).damaged(nodeOf(node)); }
    bool isAway() const override {
        return std::ranges::any_of(stores_, [](const auto& store) { return store->isAway(); });
    }
    std::uint64_t capacity() const override {
        std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
        for (const auto& store : stores_) least = std::min(least, store->capacity());
        return least;
    }
    /// They are the clouds' own.
    std::uint64_t bytesResident() const override { return 0; }

  private:
    /// While blocks of one store are waited for, those of the others come, too.
    class Ahead {
      public:
        Ahead(TogetherStore& all, const std::vector<PartOfNodes>& parts) : all_(all) {
            const auto has = [](const PartOfNodes& part) { return !part.nodes.empty(); };
            if (std::ranges::count_if(parts, has) < 2) return;
            waiter_ = newWaiter();
            for (std::size_t s = 0; s < parts.size(); ++s) {
                std::vector<BlockRequest> requests;
                for (const std::uint32_t node : parts[s].nodes) requests.push_back({node, 0});
                all_.stores_[s]->request(waiter_, std::move(requests));
            }
        }
        ~Ahead() {
            if (waiter_ != 0)
                for (const auto& store : all_.stores_) store->request(waiter_, {});
        }
        Ahead(const Ahead&) = delete;
        Ahead& operator=(const Ahead&) = delete;

      private:
        TogetherStore& all_;
        std::uint64_t waiter_ = 0;
    };

    std::size_t storeIndex(std::uint32_t node) const { return of_[together_->places[node].member]; }
    SampleStore& storeOf(std::uint32_t node) const { return *stores_[storeIndex(node)]; }
    std::uint32_t nodeOf(std::uint32_t node) const { return together_->places[node].node; }
    std::vector<PartOfNodes> partsOf(std::span<const std::uint32_t> nodes) const {
        std::vector<PartOfNodes> parts(stores_.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            PartOfNodes& part = parts[storeIndex(nodes[i])];
            part.nodes.push_back(nodeOf(nodes[i]));
            part.places.push_back(i);
        }
        return parts;
    }

    const std::shared_ptr<const Together> together_;
    std::vector<std::shared_ptr<SampleStore>> stores_;
    std::vector<std::size_t> of_;  ///< in stores_, by member
};

}  // namespace

std::shared_ptr<SampleStore> togetherStore(std::shared_ptr<const Together> together) {
    return std::make_shared<TogetherStore>(std::move(together));
}

}  // namespace scancast
