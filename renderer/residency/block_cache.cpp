#include "renderer/residency/block_cache.hpp"

#include <algorithm>
#include <stop_token>
#include <thread>
#include <tuple>

#include "renderer/residency/block_table.hpp"
#include "renderer/residency/demand.hpp"
#include "renderer/residency/request_queue.hpp"
#include "threads/guarded.hpp"
#include "threads/monitor.hpp"

namespace scancast {

namespace {

using CachedCloud = BlockTable::CloudBlocks;

// Of one cloud; a screenful of samples, so that a picture is never coarser than that.
constexpr std::uint64_t mostPinned = 16u << 20;
constexpr std::uint64_t pinsRequester = ~0ull;
// Of a cloud behind a network, that are fetched before anybody asks: they would be in the way of the first picture.
constexpr std::uint64_t mostFetchedAhead = 4u << 20;

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
    const std::span<const BesideWord> beside = block->beside;
    return {samples, limits, std::move(block), beside};
}

class Cache final : public BlockCache, public std::enable_shared_from_this<Cache> {
  public:
    explicit Cache(const BlockCacheOptions& options)
        : options_(options), table_(options.memoryLimit, options.grace.count()) {
        for (int i = 0; i < std::max(1, options.threads); ++i)
            threads_.emplace_back([this] { loadLoop(Lane::Local); });
    }
    ~Cache() override {
        stop();
        for (std::thread& thread : threads_) thread.join();
    }

    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) override {
        return add(std::move(file), mostPinned);
    }
    /// What is made of a cloud for a view pins its root alone: there may be many, and they come and go.
    std::shared_ptr<SampleStore> addDerived(std::shared_ptr<const CloudFile> file) override {
        return add(std::move(file), 0);
    }
    std::shared_ptr<const void> reserve(std::uint64_t bytes) override {
        return std::make_shared<const Block>(table_.meter(), bytes);
    }
    BlockCacheStats stats() const override;
    void stop() override;

    std::optional<SampleRun> find(CachedCloud& cloud, std::uint32_t node);
    std::vector<std::optional<SampleRun>> findAll(CachedCloud& cloud, std::span<const std::uint32_t> nodes);
    std::vector<Expected<SampleRun>> loadAll(CachedCloud& cloud, std::span<const std::uint32_t> nodes,
                                             const std::stop_token& stop);
    void request(CachedCloud& cloud, std::uint64_t requester, std::vector<BlockRequest> requests);
    bool damaged(CachedCloud& cloud, std::uint32_t node);
    void remove(CachedCloud& cloud);
    std::uint64_t limit() const { return table_.limit(); }

  private:
    class Enlisted;
    using Lock = Monitor::Lock;
    using Loaded = Expected<std::shared_ptr<const Block>>;

    /// Files of this machine, and those of others, which nobody who reads the former waits for.
    enum class Lane : std::uint8_t { Local, Remote };
    static Lane laneOf(const CachedCloud& cloud) { return cloud.isRemote ? Lane::Remote : Lane::Local; }
    RequestQueue& requestsOf(Lane lane) { return lane == Lane::Remote ? remoteRequests_ : requests_; }
    const RequestQueue& requestsOf(Lane lane) const {
        return lane == Lane::Remote ? remoteRequests_ : requests_;
    }

    // What threads wait for; with the lock held.
    bool loadIsDue(Lane lane) const {
        return stopping_ || anyDemandHasWork(lane) || !requestsOf(lane).empty();
    }
    bool isOver(const Demand& demand) const { return demand.complete() || stopping_; }

    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file, std::uint64_t mostPins);
    void startRemoteThreads();
    void loadLoop(Lane lane);
    void serveDemand(Lane lane, Lock& lock);
    void serveRequest(Lane lane, Lock& lock);
    bool anyDemandHasWork(Lane lane) const;
    void work(Demand& demand, Lock& lock);
    void look(CachedCloud& cloud, std::uint32_t node, Lock& lock);
    void load(std::shared_ptr<CachedCloud> cloud, std::uint32_t node, std::shared_ptr<Block> room,
              Lock& lock);
    Loaded read(const CachedCloud& cloud, std::uint32_t node, std::shared_ptr<Block> room) const;
    void answer(const CachedCloud& cloud, std::uint32_t node, const Loaded& result);

    const BlockCacheOptions options_;
    mutable Monitor monitor_;  // guards what follows
    BlockTable table_;
    RequestQueue requests_, remoteRequests_;
    std::vector<Demand*> demands_;
    std::size_t turn_ = 0;  // of the demands
    std::uint64_t loaded_ = 0, damaged_ = 0;
    int remoteThreads_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

// ---- store
// ----------------------------------------------------------------------------------------------------

class ResidentStore final : public SampleStore {
  public:
    ResidentStore(std::shared_ptr<Cache> cache, std::shared_ptr<CachedCloud> cloud)
        : cache_(std::move(cache)), cloud_(std::move(cloud)), tables_(cache_->reserve(tableBytes())) {}
    ~ResidentStore() override {
        gate_->close();
        cache_->remove(*cloud_);
    }
    std::shared_ptr<StoreGate> gate() const override { return gate_; }

    std::optional<SampleRun> find(std::uint32_t node) override { return cache_->find(*cloud_, node); }
    std::vector<std::optional<SampleRun>> findAll(std::span<const std::uint32_t> nodes) override {
        return cache_->findAll(*cloud_, nodes);
    }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override {
        return std::move(cache_->loadAll(*cloud_, std::span(&node, 1), stop).front());
    }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override {
        return cache_->loadAll(*cloud_, nodes, stop);
    }
    void request(std::uint64_t requester, std::vector<BlockRequest> requests) override {
        cache_->request(*cloud_, requester, std::move(requests));
    }
    bool whole() const override { return false; }
    bool damaged(std::uint32_t node) const override { return cache_->damaged(*cloud_, node); }
    bool isAway() const override { return cloud_->file->isAway(); }
    /// Depends on the limit and the cloud alone: pictures must not depend on what else is in memory.
    std::uint64_t capacity() const override {
        const std::uint64_t tables = std::min(tableBytes(), cache_->limit());
        return (cache_->limit() - tables) / 4 * 3 / BlockTable::bytesPerSample(*cloud_);
    }
    std::uint64_t bytesResident() const override { return cloud_->bytes; }
    std::shared_ptr<const CloudFile> cloudFile() const override { return cloud_->file; }

  private:
    /// Nodes stand in the file's own tables, the octree's and the block table's.
    std::uint64_t tableBytes() const {
        const std::uint64_t places = sizeof(StoredNode) + cloud_->file->planes().size() * sizeof(BlockPlace);
        return cloud_->slots.size() * (places + sizeof(Node) + sizeof(BlockTable::Slot)) +
               cloud_->file->ownMemory();
    }

    const std::shared_ptr<Cache> cache_;
    const std::shared_ptr<CachedCloud> cloud_;
    const std::shared_ptr<const void> tables_;
    const std::shared_ptr<StoreGate> gate_ = std::make_shared<StoreGate>(*this);
};

std::shared_ptr<SampleStore> Cache::add(std::shared_ptr<const CloudFile> file, std::uint64_t mostPins) {
    std::shared_ptr<CachedCloud> cloud;
    {
        const Lock lock(monitor_);
        // However many clouds there are, their pins leave three quarters of the memory to what is looked at.
        const std::uint64_t all = table_.limit() / 4;
        const std::uint64_t left = all - std::min(all, table_.pinnedBytes());
        cloud = table_.add(std::move(file), std::min({mostPins, table_.limit() / 16, left}));
        if (cloud->isRemote) startRemoteThreads();
    }
    std::vector<BlockRequest> pins;
    std::uint64_t ahead = 0;
    for (std::uint32_t node = 0; node < cloud->slots.size() && cloud->slots[node].pinned; ++node) {
        ahead += BlockTable::bytesOf(*cloud, node);
        if (cloud->isRemote && ahead > mostFetchedAhead) break;
        pins.push_back({node, -double(node)});
    }
    auto store = std::make_shared<ResidentStore>(shared_from_this(), cloud);
    store->derived().setStoreMaker(
        [cache = weak_from_this()](std::shared_ptr<const CloudFile> made) -> std::shared_ptr<SampleStore> {
            const auto there = cache.lock();
            return there ? there->addDerived(std::move(made)) : nullptr;
        });
    store->request(pinsRequester, std::move(pins));
    return store;
}

void Cache::remove(CachedCloud& cloud) {
    const Lock lock(monitor_);
    requestsOf(laneOf(cloud)).forget(cloud.id);
    table_.remove(cloud);
}

std::optional<SampleRun> Cache::find(CachedCloud& cloud, std::uint32_t node) {
    const BlockTable::Time time = now();
    const Lock lock(monitor_);
    auto block = table_.use(cloud, node, time);
    if (!block) return std::nullopt;
    return runOf(std::move(block));
}

std::vector<std::optional<SampleRun>> Cache::findAll(CachedCloud& cloud,
                                                     std::span<const std::uint32_t> nodes) {
    std::vector<std::optional<SampleRun>> found(nodes.size());
    const BlockTable::Time time = now();
    const Lock lock(monitor_);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (auto block = table_.use(cloud, nodes[i], time)) found[i] = runOf(std::move(block));
    return found;
}

bool Cache::damaged(CachedCloud& cloud, std::uint32_t node) {
    const Lock lock(monitor_);
    return table_.state(cloud, node, now()) == BlockState::Damaged && !table_.isAway(cloud, node);
}

void Cache::request(CachedCloud& cloud, std::uint64_t requester, std::vector<BlockRequest> requests) {
    const BlockTable::Time time = now();
    const Lock lock(monitor_);
    std::erase_if(requests, [&](const BlockRequest& request) {
        return request.node >= cloud.slots.size() ||
               table_.state(cloud, request.node, time) != BlockState::Absent;
    });
    requestsOf(laneOf(cloud)).set(cloud.id, requester, std::move(requests));
}

// ---- waiting
// --------------------------------------------------------------------------------------------------

/// A demand in the list of all, as long as somebody waits for it.
class Cache::Enlisted {
  public:
    Enlisted(std::vector<Demand*>& all, Demand& one) : all_(all), one_(one) { all_.push_back(&one_); }
    ~Enlisted() { std::erase(all_, &one_); }
    Enlisted(const Enlisted&) = delete;
    Enlisted& operator=(const Enlisted&) = delete;

  private:
    std::vector<Demand*>& all_;
    Demand& one_;
};

std::vector<Expected<SampleRun>> Cache::loadAll(CachedCloud& cloud, std::span<const std::uint32_t> nodes,
                                                const std::stop_token& stop) {
    Demand demand(cloud, nodes);
    {
        Lock lock(monitor_);
        const Enlisted enlisted(demands_, demand);
        // The waiting thread is a loader thread for itself meanwhile; but a read over a network cannot be called off.
        const bool works = !cloud.isRemote || remoteThreads_ == 0;
        while (!isOver(demand) && !stop.stop_requested()) {
            if (works && demand.hasWork())
                work(demand, lock);
            else
                monitor_.wait(lock, stop, [&] { return isOver(demand); });
        }
    }

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

// The next block of a demand, which is answered for it whatever happens.
void Cache::work(Demand& demand, Lock& lock) {
    const std::uint32_t node = demand.takeNode();
    auto worked = guarded("Loading a block", [&] { look(demand.cloud(), node, lock); });
    if (!worked) answer(demand.cloud(), node, tl::unexpected(std::move(worked.error())));
}

// Here already, being loaded by somebody else, or ours to load.
void Cache::look(CachedCloud& cloud, std::uint32_t node, Lock& lock) {
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

void Cache::answer(const CachedCloud& cloud, std::uint32_t node, const Loaded& result) {
    for (Demand* demand : demands_) demand->answer(cloud, node, result);
}

// ---- loader threads
// -------------------------------------------------------------------------------------------

// With the lock held: once, for as long as the cache lives. Fewer than were wanted will do; where there is none, who waits
// for blocks reads them.
void Cache::startRemoteThreads() {
    if (remoteThreads_ > 0) return;
    std::ignore = guarded("Starting a thread", [&] {
        for (int i = 0; i < std::max(1, options_.remoteThreads); ++i)
            threads_.emplace_back([this] { loadLoop(Lane::Remote); }), ++remoteThreads_;
    });
}

void Cache::loadLoop(Lane lane) {
    Lock lock(monitor_);
    while (true) {
        monitor_.wait(lock, [&] { return loadIsDue(lane); });
        if (stopping_) return;
        // One for somebody who waits, one for those who make do with ancestors meanwhile.
        serveDemand(lane, lock);
        if (!stopping_) std::ignore = guarded("Loading a block", [&] { serveRequest(lane, lock); });
    }
}

bool Cache::anyDemandHasWork(Lane lane) const {
    return std::ranges::any_of(demands_,
                               [&](const Demand* d) { return laneOf(d->cloud()) == lane && d->hasWork(); });
}

void Cache::serveDemand(Lane lane, Lock& lock) {
    for (std::size_t i = 0; i < demands_.size(); ++i) {
        Demand* demand = demands_[++turn_ % demands_.size()];
        if (laneOf(demand->cloud()) == lane && demand->hasWork()) return work(*demand, lock);
    }
}

// Where there is no memory even to begin, a request is dropped, like one that there is no room for: whoever
// still has it asks again with the next picture.
void Cache::serveRequest(Lane lane, Lock& lock) {
    while (const auto next = requestsOf(lane).next()) {
        auto cloud = table_.find(next->cloud);
        if (!cloud || table_.state(*cloud, next->node, now()) != BlockState::Absent) continue;
        auto room = table_.beginLoad(*cloud, next->node, false, now());
        if (!room) continue;
        return load(std::move(cloud), next->node, std::move(room), lock);
    }
}

// Reads without the lock; the slot is Loading meanwhile, and whatever happens, it is not afterwards.
void Cache::load(std::shared_ptr<CachedCloud> cloud, std::uint32_t node, std::shared_ptr<Block> room,
                 Lock& lock) {
    lock.unlock();
    Loaded result = guarded("Reading a block", [&] { return read(*cloud, node, std::move(room)); });
    room.reset();
    lock.lock();
    if (result) {
        auto kept = guarded("Keeping a block", [&] { table_.finishLoad(*cloud, node, *result, now()); });
        if (!kept) result = tl::unexpected(std::move(kept.error()));
    }
    if (result) {
        ++loaded_;
    } else {
        if (result.error().code != ErrorCode::Unavailable) ++damaged_;
        bool tell = false;
        std::ignore = guarded("Remembering a block",
                              [&] { tell = table_.failLoad(*cloud, node, result.error(), now()); });
        if (tell && options_.onDamaged) {
            lock.unlock();
            std::ignore =
                guarded("Telling of a block", [&] { options_.onDamaged(cloud->file, result.error()); });
            lock.lock();
        }
    }
    answer(*cloud, node, result);
}

Cache::Loaded Cache::read(const CachedCloud& cloud, std::uint32_t node, std::shared_ptr<Block> room) const {
    auto samples = cloud.file->samples(node);
    if (!samples) return passOn(std::move(samples));
    if (cloud.file->countsVary()) {
        // Its index estimates; what is really there counts.
        const std::uint64_t bytes = BlockTable::bytesFor(cloud, samples->size());
        if (bytes != room->bytes()) room = std::make_shared<Block>(table_.meter(), bytes);
    } else if (samples->size() != cloud.file->nodes()[node].node.sampleCount) {
        return fail(ErrorCode::Malformed,
                    "Node " + std::to_string(node) + " has another number of samples than its index says.");
    }
    // A node that has none of a plane has 0 everywhere.
    if (cloud.hasBeside()) room->beside.assign(samples->size(), 0);
    if (cloud.curvaturePlane) {
        const auto values = cloud.file->plane(node, *cloud.curvaturePlane);
        if (!values) return passOn(values);
        std::ranges::copy(*values, std::as_writable_bytes(std::span(room->beside)).begin());
        for (BesideWord& word : room->beside) word = curvatureIn(word);
    }
    if (cloud.nearInfraredPlane) {
        const auto values = cloud.file->plane(node, *cloud.nearInfraredPlane);
        if (!values) return passOn(values);
        for (std::size_t i = 0; i < values->size(); ++i)
            room->beside[i] = withNearInfrared(room->beside[i], std::to_integer<std::uint8_t>((*values)[i]));
    }
    room->limits = limitsOf(*samples);
    room->samples = std::move(*samples);
    return room;
}

// ---- the rest
// -------------------------------------------------------------------------------------------------

void Cache::stop() {
    const Lock lock(monitor_);
    stopping_ = true;
}

BlockCacheStats Cache::stats() const {
    const Monitor::Look look(monitor_);
    return {table_.limit(),   table_.bytes(), loaded_,
            table_.evicted(), damaged_,       requests_.size() + remoteRequests_.size()};
}

}  // namespace

std::shared_ptr<BlockCache> BlockCache::create(const BlockCacheOptions& options) {
    return std::make_shared<Cache>(options);
}

}  // namespace scancast
