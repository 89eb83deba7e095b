// The clouds of ranks that draw together. At rank 0, as the server opens them: of each cloud file that all ranks have opened the
// samples of rank 0's share; what some rank does not have, rank 0 has whole and draws alone. At the others: what rank 0 opens, at the
// same moment, by its path and revision; the share's samples are loaded as drawings need them. Behind a front (ranks/front/) rank 0 is
// as the others.
//
// *Thread safety*: all functions may be called from any thread, but openWithFirst(), which has one of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "ranks/draw/packed_drawing.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"
#include "renderer/residency/node_share.hpp"

namespace scancast {

/// A block cache whose clouds are drawn with the others. Not those that some rank cannot open with the same revision, and not those
/// that no look is kept of, which is found by looking at the whole cloud: they stay whole, and rank 0 draws them alone.
class SharedClouds final : public BlockCache {
  public:
    /// Told of each cloud that is not shared: which, why, and the way out.
    using OnAlone = std::function<void(const std::string&)>;

    /// `opening`: for nothing but this, and the others' openWithFirst(); outlives it.
    SharedClouds(std::shared_ptr<BlockCache> cache, NodeShare share, const Communicator& opening,
                 OnAlone onAlone)
        : cache_(std::move(cache)), share_(share), opening_(opening), onAlone_(std::move(onAlone)) {}

    /// Waits until all ranks have opened the file.
    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) override;
    std::shared_ptr<const void> reserve(std::uint64_t bytes) override { return cache_->reserve(bytes); }
    BlockCacheStats stats() const override { return cache_->stats(); }
    void stop() override { cache_->stop(); }

    /// Drawings of this cloud may come: they know their octree's source alone.
    void know(const std::shared_ptr<const Cloud>& cloud);
    /// nullopt: it is all here, and drawn by rank 0 alone. Internal: nobody told know() of it, so it cannot be said who draws it.
    Expected<std::optional<CloudPlace>> placeOf(std::uint64_t source) const;
    /// From now on nothing is shared: the others are about to be let go.
    void close();

  private:
    struct Known {
        std::weak_ptr<const Cloud> cloud;
        std::optional<CloudPlace> place;
    };

    /// Why this file cannot be shared; nullopt: all have opened it.
    std::optional<std::string> openOnAll(const std::shared_ptr<const CloudPlace>& place);

    const std::shared_ptr<BlockCache> cache_;
    const NodeShare share_;
    const Communicator& opening_;
    const OnAlone onAlone_;
    std::mutex opens_;  // while ranks open a file
    bool closed_ = false;
    std::vector<std::weak_ptr<const CloudPlace>> shared_;
    mutable std::mutex mutex_;
    std::unordered_map<std::uint64_t, Known> known_;  // by source
};

class OpenedClouds {
  public:
    /// `opening`: as rank 0's; outlives it.
    OpenedClouds(std::shared_ptr<BlockCache> cache, NodeShare share, const Communicator& opening)
        : cache_(std::move(cache)), share_(share), opening_(opening) {}

    /// Opens what rank 0 opens, and closes what it no longer has, until it lets go. What MPI does not like ends all ranks.
    void openWithFirst();
    /// At a first rank that has no cloud of its own, in place of it: has all open what the words name - a path and a revision, then
    /// those of everything that is still wanted, each ended by a 0. How many samples of it all may hold together for one picture.
    /// Errors: why one of them cannot open it. What MPI does not like ends all ranks.
    Expected<std::uint64_t> openOnAll(const RankBytes& words);
    /// The share's samples of all cuts, in memory as long as the drawing lives. Waits for them. Errors: InvalidArgument where
    /// the cloud is none that was opened; the block's, where one is damaged.
    Expected<void> provide(UnpackedDrawing& drawing);
    /// A drawing of these bytes, provided; what is thrown on the way is this rank's error. Errors: unpackDrawing()'s, provide()'s,
    /// ResourceLimit.
    Expected<std::unique_ptr<UnpackedDrawing>> unpack(std::span<const std::byte> bytes);

  private:
    Expected<std::shared_ptr<const Cloud>> find(const CloudPlace& place);
    Expected<void> open(const std::vector<std::string>& words);

    const std::shared_ptr<BlockCache> cache_;
    const NodeShare share_;
    const Communicator& opening_;
    std::mutex mutex_;
    std::unordered_map<std::string, std::shared_ptr<const Cloud>> clouds_;  // by path and revision
};

}  // namespace scancast
