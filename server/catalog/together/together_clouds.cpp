#include "server/catalog/together/together_clouds.hpp"

#include <algorithm>
#include <utility>

namespace scancast {
namespace {

/// Of samples that are tinted, where the server has no cache: its clouds are all in memory then.
constexpr std::uint64_t ownCacheBytes = std::uint64_t(256) << 20;

bool isSame(const TogetherMember& a, const TogetherMember& b) {
    return a.name == b.name && a.cloud == b.cloud && a.shift == b.shift && a.tint == b.tint &&
           a.hidden == b.hidden;
}

}  // namespace

void TogetherClouds::setCache(std::shared_ptr<BlockCache> cache) {
    const std::lock_guard lock(mutex_);
    cache_ = std::move(cache);
}

// With the lock held.
std::shared_ptr<const Cloud> TogetherClouds::find(const std::vector<TogetherMember>& members, bool byCloud) {
    const auto known = std::ranges::find_if(clouds_, [&](const auto& cloud) {
        const Together& together = *cloud->together;
        return together.byCloud == byCloud && std::ranges::equal(together.members, members, isSame);
    });
    if (known == clouds_.end()) return nullptr;
    clouds_.splice(clouds_.begin(), clouds_, known);
    return clouds_.front();
}

Expected<std::shared_ptr<const Cloud>> TogetherClouds::of(std::vector<TogetherMember> members, bool byCloud) {
    std::shared_ptr<BlockCache> cache;
    std::shared_ptr<const Cloud> like;
    {
        const std::lock_guard lock(mutex_);
        if (auto known = find(members, byCloud)) return known;
        if (!cache_) {
            BlockCacheOptions own;
            own.memoryLimit = ownCacheBytes;
            own.threads = 1;
            cache_ = BlockCache::create(own);
        }
        cache = cache_;
        for (const auto& cloud : clouds_)
            if (!like && cloud->together->members.front().cloud == members.front().cloud) like = cloud;
    }
    auto made = putTogether(members, byCloud, cache, like.get());
    if (!made && made.error().code == ErrorCode::Unavailable) {
        // What is only kept makes room for what is asked for.
        Clouds gone;
        {
            const std::lock_guard lock(mutex_);
            gone.swap(clouds_);
        }
        gone.clear();
        made = putTogether(members, byCloud, cache, like.get());
    }
    if (!made) return made;
    Clouds gone;
    const std::lock_guard lock(mutex_);
    if (auto known = find(members, byCloud)) return known;  // somebody was first
    clouds_.push_front(*made);
    std::uint64_t nodes = 0;
    std::size_t kept = 0;
    for (const auto& cloud : clouds_) {
        nodes += cloud->octree.nodes().size();
        if (kept > 0 && (kept == most || nodes > mostNodes)) break;
        ++kept;
    }
    gone.splice(gone.begin(), clouds_, std::next(clouds_.begin(), std::ptrdiff_t(kept)), clouds_.end());
    return made;
}

TogetherClouds::Clouds TogetherClouds::forget(const Cloud* member) {
    Clouds gone;
    const std::lock_guard lock(mutex_);
    for (auto at = clouds_.begin(); at != clouds_.end();) {
        const auto next = std::next(at);
        const auto isOf = [&](const TogetherMember& one) { return one.cloud.get() == member; };
        if (std::ranges::any_of((*at)->together->members, isOf)) gone.splice(gone.end(), clouds_, at);
        at = next;
    }
    return gone;
}

std::size_t TogetherClouds::size() const {
    const std::lock_guard lock(mutex_);
    return clouds_.size();
}

}  // namespace scancast
