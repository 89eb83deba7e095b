#include "renderer/cloud/sample_store.hpp"

#include <limits>

namespace scancast {

std::vector<std::optional<SampleRun>> SampleStore::findAll(std::span<const std::uint32_t> nodes) {
    std::vector<std::optional<SampleRun>> found;
    found.reserve(nodes.size());
    for (const std::uint32_t node : nodes) found.push_back(find(node));
    return found;
}

namespace {

class MemoryStore final : public SampleStore {
  public:
    MemoryStore(std::vector<Sample> samples, std::vector<std::uint64_t> first, std::vector<BesideWord> beside)
        : samples_(std::move(samples)), beside_(std::move(beside)), first_(std::move(first)) {
        firstLimits_.reserve(first_.size());
        for (std::size_t run = 0; run + 1 < first_.size(); ++run) {
            firstLimits_.push_back(limits_.size());
            const std::vector<SampleLimits> limits = limitsOf(samplesOf(run));
            limits_.insert(limits_.end(), limits.begin(), limits.end());
        }
        firstLimits_.push_back(limits_.size());
    }

    ~MemoryStore() override { gate_->close(); }
    std::shared_ptr<StoreGate> gate() const override { return gate_; }

    // Whoever asks holds the octree, and with it this store: nothing needs to be kept.
    std::optional<SampleRun> find(std::uint32_t node) override { return run(node); }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token) override { return run(node); }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes, std::stop_token) override {
        std::vector<Expected<SampleRun>> runs;
        runs.reserve(nodes.size());
        for (const std::uint32_t node : nodes) runs.emplace_back(run(node));
        return runs;
    }
    void request(std::uint64_t, std::vector<BlockRequest>) override {}
    bool whole() const override { return true; }
    bool damaged(std::uint32_t) const override { return false; }
    std::uint64_t capacity() const override { return std::numeric_limits<std::uint64_t>::max(); }
    std::uint64_t bytesResident() const override {
        return samples_.size() * sizeof(Sample) + limits_.size() * sizeof(SampleLimits) +
               beside_.size() * sizeof(BesideWord);
    }

  private:
    SampleRun run(std::uint32_t node) const {
        const std::span limits =
            std::span(limits_).subspan(firstLimits_[node], firstLimits_[node + 1] - firstLimits_[node]);
        return {samplesOf(node), limits, nullptr, partOf<BesideWord>(beside_, node)};
    }
    std::span<const Sample> samplesOf(std::size_t run) const { return partOf<Sample>(samples_, run); }
    /// Of values of all samples, or of none.
    template <class T>
    std::span<const T> partOf(std::span<const T> all, std::size_t run) const {
        return all.empty() ? all : all.subspan(first_[run], first_[run + 1] - first_[run]);
    }

    const std::vector<Sample> samples_;
    const std::vector<BesideWord> beside_;
    const std::vector<std::uint64_t> first_;
    std::vector<SampleLimits> limits_;
    std::vector<std::size_t> firstLimits_;  ///< by run
    const std::shared_ptr<StoreGate> gate_ = std::make_shared<StoreGate>(*this);
};

}  // namespace

std::shared_ptr<SampleStore> memoryStore(std::vector<Sample> samples, std::vector<std::uint64_t> first,
                                         std::vector<BesideWord> beside) {
    return std::make_shared<MemoryStore>(std::move(samples), std::move(first), std::move(beside));
}

}  // namespace scancast
