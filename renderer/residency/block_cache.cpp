#include "renderer/residency/block_cache.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>

#include "renderer/residency/block_table.hpp"
#include "renderer/residency/demand.hpp"
#include "renderer/residency/wish_list.hpp"

namespace scancast {

namespace {

using CachedCloud = BlockTable::Cloud;

// Of one cloud; a screenful of samples, so that a picture is never coarser than that.
constexpr std::uint64_t mostPinned = 16u << 20;
constexpr std::uint64_t pinsRequester = ~0ull;

BlockTable::Time now() {
    using namespace std::chrono;
    return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

Error cancelled() {
    return Error{ErrorCode::Cancelled, "The samples are not wanted any more.", {}};
}

SampleRun runOf(std::shared_ptr<const Block> block) {
    const std::span<const Sample> samples = block->samples;
    const std::span<const SampleLimits> limits = block->limits;
    return {samples, limits, std::move(block)};
}

class Cache final : public BlockCache, public std::enable_shared_from_this<Cache> {
  public:
    explicit Cache(const BlockCacheOptions& options)
        : options_(options), table_(options.memoryLimit, options.grace.count()) {
        for (int i = 0; i < std::max(1, options.threads); ++i) threads_.emplace_back([this] { loadLoop(); });
    }
    ~Cache() override {
        stop();
        for (std::thread& thread : threads_) thread.join();
    }

    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) override;
    std::shared_ptr<const void> reserve(std::uint64_t bytes) override {
        return std::make_shared<const Block>(table_.meter(), bytes);
    }
    BlockCacheStats stats() const override;
    void stop() override;

    std::optional<SampleRun> find(CachedCloud& cloud, std::uint32_t node);
    std::vector<Expected<SampleRun>> loadAll(CachedCloud& cloud, std::span<const std::uint32_t> nodes,
                                             const std::stop_token& stop);
    void request(CachedCloud& cloud, std::uint64_t requester, std::vector<Wish> wishes);
    bool damaged(CachedCloud& cloud, std::uint32_t node);
    void remove(CachedCloud& cloud);
    std::uint64_t limit() const { return table_.limit(); }

  private:
    using Lock = std::unique_lock<std::mutex>;

    void loadLoop();
    bool serveDemand(Lock& lock);
    bool serveWish(Lock& lock);
    bool anyDemandHasWork() const;
    void work(Demand& demand, Lock& lock);
    void load(std::shared_ptr<CachedCloud> cloud, std::uint32_t node, std::shared_ptr<Block> room,
              Lock& lock);
    void answer(const CachedCloud& cloud, std::uint32_t node,
                const Expected<std::shared_ptr<const Block>>& result);

    const BlockCacheOptions options_;
    mutable std::mutex mutex_;
    std::condition_variable work_;         // wishes_ or demands_ grew, stopping_
    std::condition_variable_any changed_;  // a demand was answered, stopping_
    BlockTable table_;
    WishList wishes_;
    std::vector<Demand*> demands_;
    std::size_t turn_ = 0;  // of the demands
    std::uint64_t loaded_ = 0, damaged_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

// ---- store
// ----------------------------------------------------------------------------------------------------

class ResidentStore final : public SampleStore {
  public:
    ResidentStore(std::shared_ptr<Cache> cache, std::shared_ptr<CachedCloud> cloud)
        : cache_(std::move(cache)), cloud_(std::move(cloud)), tables_(cache_->reserve(tableBytes())) {}
    ~ResidentStore() override { cache_->remove(*cloud_); }

    std::optional<SampleRun> find(std::uint32_t node) override { return cache_->find(*cloud_, node); }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override {
        return std::move(cache_->loadAll(*cloud_, std::span(&node, 1), stop).front());
    }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override {
        return cache_->loadAll(*cloud_, nodes, stop);
    }
    void request(std::uint64_t requester, std::vector<Wish> wishes) override {
        cache_->request(*cloud_, requester, std::move(wishes));
    }
    bool whole() const override { return false; }
    bool damaged(std::uint32_t node) const override { return cache_->damaged(*cloud_, node); }
    /// Depends on the limit and the cloud alone: pictures must not depend on what else is in memory.
    std::uint64_t capacity() const override {
        const std::uint64_t tables = std::min(tableBytes(), cache_->limit());
        return (cache_->limit() - tables) / 4 * 3 / sizeof(Sample);
    }
    std::uint64_t bytesResident() const override { return cloud_->bytes; }

  private:
    /// Nodes stand in the file's own table, the octree's and the block table's.
    std::uint64_t tableBytes() const {
        return cloud_->slots.size() * (sizeof(StoredNode) + sizeof(Node) + sizeof(BlockTable::Slot));
    }

    const std::shared_ptr<Cache> cache_;
    const std::shared_ptr<CachedCloud> cloud_;
    const std::shared_ptr<const void> tables_;
};

std::shared_ptr<SampleStore> Cache::add(std::shared_ptr<const CloudFile> file) {
    std::shared_ptr<CachedCloud> cloud;
    {
        const Lock lock(mutex_);
        // However many clouds there are, their pins leave three quarters of the memory to what is looked at.
        const std::uint64_t all = table_.limit() / 4;
        const std::uint64_t left = all - std::min(all, table_.pinnedBytes());
        cloud = table_.add(std::move(file), std::min({mostPinned, table_.limit() / 16, left}));
    }
    std::vector<Wish> pins;
    for (std::uint32_t node = 0; node < cloud->slots.size() && cloud->slots[node].pinned; ++node)
        pins.push_back({node, -double(node)});
    auto store = std::make_shared<ResidentStore>(shared_from_this(), cloud);
    store->request(pinsRequester, std::move(pins));
    return store;
}

void Cache::remove(CachedCloud& cloud) {
    const Lock lock(mutex_);
    wishes_.forget(cloud.id);
    table_.remove(cloud);
}

std::optional<SampleRun> Cache::find(CachedCloud& cloud, std::uint32_t node) {
    const BlockTable::Time time = now();
    const Lock lock(mutex_);
    auto block = table_.use(cloud, node, time);
    if (!block) return std::nullopt;
    return runOf(std::move(block));
}

bool Cache::damaged(CachedCloud& cloud, std::uint32_t node) {
    const Lock lock(mutex_);
    return table_.state(cloud, node, now()) == BlockState::Damaged;
}

void Cache::request(CachedCloud& cloud, std::uint64_t requester, std::vector<Wish> wishes) {
    const BlockTable::Time time = now();
    {
        const Lock lock(mutex_);
        std::erase_if(wishes, [&](const Wish& wish) {
            return wish.node >= cloud.slots.size() ||
                   table_.state(cloud, wish.node, time) != BlockState::Absent;
        });
        wishes_.set(cloud.id, requester, std::move(wishes));
    }
    work_.notify_all();
}

// ---- waiting
// --------------------------------------------------------------------------------------------------

std::vector<Expected<SampleRun>> Cache::loadAll(CachedCloud& cloud, std::span<const std::uint32_t> nodes,
                                                const std::stop_token& stop) {
    Demand demand(cloud, nodes);
    Lock lock(mutex_);
    demands_.push_back(&demand);
    work_.notify_all();
    // The waiting thread is a loader thread for itself meanwhile.
    while (!demand.complete() && !stopping_ && !stop.stop_requested()) {
        if (demand.hasWork()) {
            work(demand, lock);
        } else {
            changed_.wait(lock, stop, [&] { return demand.complete() || stopping_; });
        }
    }
    std::erase(demands_, &demand);
    lock.unlock();

    std::vector<Expected<SampleRun>> runs;
    runs.reserve(nodes.size());
    for (const std::uint32_t node : nodes) {
        const Demand::Answer& answer = demand.answerTo(node);
        if (!answer)
            runs.emplace_back(tl::unexpected(cancelled()));
        else if (*answer)
            runs.emplace_back(runOf(**answer));
        else
            runs.emplace_back(tl::unexpected(answer->error()));
    }
    return runs;
}

// The next block of a demand: here already, being loaded by somebody else, or ours to load.
void Cache::work(Demand& demand, Lock& lock) {
    const std::uint32_t node = demand.takeNode();
    CachedCloud& cloud = demand.cloud();
    switch (table_.state(cloud, node, now())) {
        case BlockState::Resident:
            return answer(cloud, node, table_.use(cloud, node, now()));
        case BlockState::Damaged:
            return answer(cloud, node, tl::unexpected(cloud.damage.at(node).error));
        case BlockState::Loading:
            return;  // whoever loads it answers
        case BlockState::Absent:
            break;
    }
    auto shared = table_.find(cloud.id);
    if (!shared) return answer(cloud, node, tl::unexpected(cancelled()));
    auto room = table_.beginLoad(cloud, node, true, now());
    load(std::move(shared), node, std::move(room), lock);
}

void Cache::answer(const CachedCloud& cloud, std::uint32_t node,
                   const Expected<std::shared_ptr<const Block>>& result) {
    for (Demand* demand : demands_) demand->answer(cloud, node, result);
    changed_.notify_all();
}

// ---- loader threads
// -------------------------------------------------------------------------------------------

void Cache::loadLoop() {
    Lock lock(mutex_);
    while (true) {
        work_.wait(lock, [&] { return stopping_ || anyDemandHasWork() || !wishes_.empty(); });
        if (stopping_) return;
        // One for somebody who waits, one for those who make do with ancestors meanwhile.
        serveDemand(lock);
        if (!stopping_) serveWish(lock);
    }
}

bool Cache::anyDemandHasWork() const {
    return std::any_of(demands_.begin(), demands_.end(), [](const Demand* d) { return d->hasWork(); });
}

bool Cache::serveDemand(Lock& lock) {
    for (std::size_t i = 0; i < demands_.size(); ++i) {
        Demand* demand = demands_[++turn_ % demands_.size()];
        if (!demand->hasWork()) continue;
        work(*demand, lock);
        return true;
    }
    return false;
}

bool Cache::serveWish(Lock& lock) {
    while (const auto next = wishes_.next()) {
        auto cloud = table_.find(next->cloud);
        if (!cloud || table_.state(*cloud, next->node, now()) != BlockState::Absent) continue;
        auto room = table_.beginLoad(*cloud, next->node, false, now());
        if (!room) continue;  // whoever still wants it asks again with the next picture
        load(std::move(cloud), next->node, std::move(room), lock);
        return true;
    }
    return false;
}

// Reads without the lock; the slot is Loading meanwhile.
void Cache::load(std::shared_ptr<CachedCloud> cloud, std::uint32_t node, std::shared_ptr<Block> room,
                 Lock& lock) {
    lock.unlock();
    const auto read = [&]() -> Expected<std::vector<Sample>> {
        try {
            return cloud->file->samples(node);
        } catch (const std::exception& e) {
            return fail(ErrorCode::ResourceLimit, std::string("A block could not be read: ") + e.what());
        }
    };
    auto samples = read();
    if (samples && samples->size() != cloud->file->nodes()[node].node.sampleCount) {
        samples = fail(ErrorCode::Malformed, "Node " + std::to_string(node) +
                                                 " has another number of samples than its index says.");
    }
    Expected<std::shared_ptr<const Block>> result = tl::unexpected(samples ? Error{} : samples.error());
    if (samples) {
        room->limits = limitsOf(*samples);
        room->samples = std::move(*samples);
        result = std::shared_ptr<const Block>(std::move(room));
    } else {
        room.reset();
        if (options_.onDamaged) options_.onDamaged(cloud->file->path(), samples.error());
    }
    lock.lock();
    if (result) {
        ++loaded_;
        table_.finishLoad(*cloud, node, *result, now());
    } else {
        ++damaged_;
        table_.failLoad(*cloud, node, result.error(), now());
    }
    answer(*cloud, node, result);
}

// ---- the rest
// -------------------------------------------------------------------------------------------------

void Cache::stop() {
    const Lock lock(mutex_);
    stopping_ = true;
    work_.notify_all();
    changed_.notify_all();
}

BlockCacheStats Cache::stats() const {
    const Lock lock(mutex_);
    return {table_.limit(), table_.bytes(), loaded_, table_.evicted(), damaged_, wishes_.size()};
}

}  // namespace

std::shared_ptr<BlockCache> BlockCache::create(const BlockCacheOptions& options) {
    return std::make_shared<Cache>(options);
}

}  // namespace scancast
