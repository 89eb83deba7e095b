#include "renderer/residency/block_table.hpp"

#include <algorithm>

namespace scancast {

std::shared_ptr<BlockTable::CloudBlocks> BlockTable::add(std::shared_ptr<const CloudFile> file,
                                                         std::uint64_t pinnedBytes) {
    auto cloud = std::make_shared<CloudBlocks>();
    cloud->id = ++lastId_;
    cloud->file = std::move(file);
    // A native cloud's blocks wait for programs, as others do for a network.
    cloud->isRemote = cloud->file->isRemote() || cloud->file->isNative();
    const auto planes = cloud->file->planes();
    const auto find = [&](const ValuePlane& plane) -> std::optional<std::size_t> {
        const auto at = std::ranges::find(planes, plane);
        return at == planes.end() ? std::nullopt : std::optional(std::size_t(at - planes.begin()));
    };
    cloud->curvaturePlane = find(curvaturePlane());
    cloud->nearInfraredPlane = find(nearInfraredPlane());
    cloud->slots.resize(cloud->file->nodes().size());
    std::uint64_t pinned = 0;
    for (std::uint32_t node = 0; node < cloud->slots.size(); ++node) {
        pinned += bytesOf(*cloud, node);
        if (node > 0 && pinned > pinnedBytes) break;
        cloud->slots[node].pinned = true;
        pinnedBytes_ += bytesOf(*cloud, node);
    }
    clouds_.emplace(cloud->id, cloud);
    return cloud;
}

void BlockTable::remove(CloudBlocks& cloud) {
    cloud.removed = true;
    for (std::uint32_t node = 0; node < cloud.slots.size(); ++node) {
        Slot& slot = cloud.slots[node];
        if (slot.pinned) pinnedBytes_ -= bytesOf(cloud, node);
        if (slot.state == BlockState::Resident && !slot.pinned) order_.erase(slot.place);
        slot = {};
    }
    cloud.bytes = 0;
    clouds_.erase(cloud.id);
}

std::shared_ptr<BlockTable::CloudBlocks> BlockTable::find(std::uint64_t id) const {
    const auto at = clouds_.find(id);
    return at == clouds_.end() ? nullptr : at->second;
}

// Ancestors that were touched at the same instant need not be touched again: nothing came between.
void BlockTable::touch(CloudBlocks& cloud, std::uint32_t node, Time now) {
    const auto nodes = cloud.file->nodes();
    for (bool first = true; node != noNode; node = nodes[node].node.parent, first = false) {
        Slot& slot = cloud.slots[node];
        if (!first && slot.usedAt == now) return;
        slot.usedAt = now;
        if (slot.state == BlockState::Resident && !slot.pinned)
            order_.splice(order_.begin(), order_, slot.place);
    }
}

std::shared_ptr<const Block> BlockTable::use(CloudBlocks& cloud, std::uint32_t node, Time now) {
    touch(cloud, node, now);
    return cloud.slots[node].block;
}

BlockState BlockTable::state(CloudBlocks& cloud, std::uint32_t node, Time now) {
    Slot& slot = cloud.slots[node];
    if (slot.state == BlockState::Damaged) {
        const Damage& damage = cloud.damage.at(node);
        const ErrorCode code = damage.error.code;
        const bool isAwayNow = code == ErrorCode::Unavailable;
        const bool mayPass = isAwayNow || code == ErrorCode::Io || code == ErrorCode::ResourceLimit ||
                             code == ErrorCode::Importer || code == ErrorCode::Cancelled ||
                             (cloud.isRemote && code == ErrorCode::Malformed);  // of the way, perhaps
        if (mayPass && now >= damage.at + (isAwayNow ? askAgain : retryAfter))
            slot.state = BlockState::Absent;
    }
    return slot.state;
}

bool BlockTable::isAway(const CloudBlocks& cloud, std::uint32_t node) const {
    const auto at = cloud.damage.find(node);
    return cloud.slots[node].state == BlockState::Damaged && at != cloud.damage.end() &&
           at->second.error.code == ErrorCode::Unavailable;
}

bool BlockTable::evictOne(bool must, Time now) {
    for (std::size_t left = order_.size(); left > 0; --left) {
        const Place last = order_.back();
        Slot& slot = last.cloud->slots[last.node];
        if (slot.block.use_count() > 1) {  // only the table hands out copies, under the cache's lock
            slot.usedAt = now;
            order_.splice(order_.begin(), order_, slot.place);
            continue;
        }
        if (!must && slot.usedAt > now - grace_) return false;
        order_.pop_back();
        last.cloud->bytes -= slot.block->bytes();
        slot.block.reset();
        slot.state = BlockState::Absent;
        ++evicted_;
        return true;
    }
    return false;
}

std::shared_ptr<Block> BlockTable::beginLoad(CloudBlocks& cloud, std::uint32_t node, bool must, Time now) {
    const std::uint64_t needed = bytesOf(cloud, node);
    while (bytes() + needed > limit_) {
        if (evictOne(must, now)) continue;
        if (!must) return nullptr;
        break;
    }
    auto room = std::make_shared<Block>(meter_, needed);
    cloud.slots[node].state = BlockState::Loading;
    return room;
}

void BlockTable::finishLoad(CloudBlocks& cloud, std::uint32_t node, std::shared_ptr<const Block> block,
                            Time now) {
    if (cloud.removed) return;
    Slot& slot = cloud.slots[node];
    if (!slot.pinned) {
        order_.push_front({&cloud, node});  // may fail for want of memory; what follows does not
        slot.place = order_.begin();
    }
    cloud.bytes += block->bytes();
    slot.block = std::move(block);
    slot.state = BlockState::Resident;
    slot.usedAt = now;
}

bool BlockTable::failLoad(CloudBlocks& cloud, std::uint32_t node, Error error, Time now) {
    if (cloud.removed) return false;
    cloud.slots[node].state = BlockState::Absent;  // and stays so where its damage cannot be remembered
    const auto [at, isNews] = cloud.damage.try_emplace(node, Damage{{}, now, now});
    Damage& damage = at->second;
    const bool isAwayNow = error.code == ErrorCode::Unavailable;
    const bool wasAway = !isNews && damage.error.code == ErrorCode::Unavailable;
    const bool tell = !isAwayNow && (isNews || wasAway || now >= damage.toldAt + toldAgain);
    damage = {std::move(error), now, tell ? now : damage.toldAt};
    cloud.slots[node].state = BlockState::Damaged;
    return tell;
}

}  // namespace scancast
