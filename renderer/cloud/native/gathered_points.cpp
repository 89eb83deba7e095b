#include "renderer/cloud/native/gathered_points.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scancast {

namespace {

// As many as there always may be in a block (32 MB). Of a file whose voxels are what they say, some 100,000.
constexpr std::size_t mostGathered = 2 << 20;
// Some blocks: one cloud that has filled the memory leaves others these.
constexpr std::uint64_t leastOwn = 8 << 20;

std::uint64_t bytesOf(const RawPoints& points) {
    return points->size() * sizeof(RawPoint) + 128;
}

}  // namespace

void GatheredMemory::take(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    if (!reserved_ && reserve_) reserved_ = reserve_(limit_);
    bytes_ += bytes;
}

void GatheredMemory::giveBack(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    bytes_ -= bytes;
}

bool GatheredMemory::isFull() const {
    const std::lock_guard lock(mutex_);
    return bytes_ > limit_;
}

std::uint64_t GatheredMemory::floor() const {
    const std::lock_guard lock(mutex_);
    return std::min(leastOwn, limit_ / std::max<std::uint64_t>(1, clouds_));
}

void GatheredMemory::join() {
    const std::lock_guard lock(mutex_);
    ++clouds_;
}

void GatheredMemory::leave() {
    const std::lock_guard lock(mutex_);
    --clouds_;
}

GatheredPoints::GatheredPoints(const AdditiveTree& tree, const VoxelTree& hierarchy,
                               const AdditiveFrame& frame, std::shared_ptr<GatheredMemory> memory,
                               OwnPoints own)
    : tree_(tree), hierarchy_(hierarchy), frame_(frame), memory_(std::move(memory)), own_(std::move(own)) {
    memory_->join();
}

GatheredPoints::~GatheredPoints() {
    memory_->giveBack(bytes_);
    memory_->leave();
}

void GatheredPoints::take(std::uint64_t bytes) {
    memory_->take(bytes);
    bytes_ += bytes;
}

void GatheredPoints::giveBack(std::uint64_t bytes) {
    memory_->giveBack(bytes);
    bytes_ -= bytes;
}

std::vector<std::uint32_t> GatheredPoints::missingFor(std::uint32_t node) const {
    std::vector<std::uint32_t> voxels;
    const Monitor::Look look(monitor_);
    for (; node != noNode && !kept_.contains(node); node = tree_.nodes[node].node.parent)
        if (const std::uint32_t voxel = tree_.own[node].voxel;
            voxel != noVoxel && hierarchy_.voxels[voxel].points > 0)
            voxels.push_back(voxel);
    return voxels;
}

Expected<RawPoints> GatheredPoints::of(std::uint32_t node) {
    // Nobody wants a leaf's but for its samples, which are kept elsewhere.
    if (tree_.nodes[node].node.isLeaf()) return gather(node);
    {
        Monitor::Lock lock(monitor_);
        // A node waits for one above it, and never the other way round.
        monitor_.wait(lock, [&] {
            const auto at = kept_.find(node);
            return at == kept_.end() || at->second.points;
        });
        if (const auto at = kept_.find(node); at != kept_.end()) {
            uses_.splice(uses_.begin(), uses_, at->second.use);
            return at->second.points;
        }
        kept_.emplace(node, Kept{});
    }
    // Whatever happens, nobody waits for ever.
    struct Ending {
        GatheredPoints& all;
        std::uint32_t node;
        ~Ending() {
            const Monitor::Lock lock(all.monitor_);
            if (const auto at = all.kept_.find(node); at != all.kept_.end() && !at->second.points)
                all.kept_.erase(at);
        }
    } const ending{*this, node};
    auto points = gather(node);
    if (points) keep(node, *points);
    return points;
}

void GatheredPoints::keep(std::uint32_t node, RawPoints points) {
    const std::uint64_t more = bytesOf(points);
    const Monitor::Lock lock(monitor_);
    if (more > memory_->limit()) return;
    uses_.push_front(node);
    kept_[node] = {std::move(points), uses_.begin()};
    take(more);
    // Its own go, down to what each may have.
    const std::uint64_t least = memory_->floor();
    while (memory_->isFull() && bytes_ > least && !uses_.empty()) {
        const auto last = kept_.find(uses_.back());
        giveBack(bytesOf(last->second.points));
        kept_.erase(last);
        uses_.pop_back();
    }
}

Expected<RawPoints> GatheredPoints::gather(std::uint32_t node) {
    const std::uint32_t parent = tree_.nodes[node].node.parent;
    const std::uint32_t voxel = tree_.own[node].voxel;
    RawPoints above, own;
    if (parent != noNode) {
        auto got = of(parent);
        if (!got) return got;
        above = std::move(*got);
    }
    if (voxel != noVoxel && hierarchy_.voxels[voxel].points > 0) {
        auto got = own_(voxel);
        if (!got) return got;
        if (!above) return got;
        own = std::move(*got);
    }
    auto all = std::make_shared<std::vector<RawPoint>>();
    if (above) {
        all->reserve((own ? own->size() : 0) + above->size() / 4);
        const Octants octants(frame_, tree_.own[parent].key);
        const auto& at = tree_.own[node].key.at;
        const int octant = (at[0] & 1) | (at[1] & 1) << 1 | (at[2] & 1) << 2;
        for (const RawPoint& point : *above)
            if (octants.of(point.at) == octant) all->push_back(point);
    }
    if (own) all->insert(all->end(), own->begin(), own->end());
    if (all->size() > mostGathered)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("more than {} points lie in one voxel{}", mostGathered, ingestInstead));
    return all;
}

}  // namespace scancast
