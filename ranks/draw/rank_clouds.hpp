// The clouds of ranks that draw together. At rank 0, as the server opens them: of each cloud file the samples of rank 0's share, and
// which files these are. At the others, by what rank 0 tells them: opened when they are first drawn, the share's samples loaded.
//
// *Thread safety*: SharedClouds' functions may be called from any thread; OpenedClouds is used on one.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "ranks/draw/packed_drawing.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"
#include "renderer/residency/node_share.hpp"

namespace scancast {

/// A block cache whose clouds are drawn with the others. Not those that no look is kept of: that is found by looking at the whole
/// cloud, so they stay whole, and rank 0 draws them alone; the log says so.
class SharedClouds final : public BlockCache {
  public:
    SharedClouds(std::shared_ptr<BlockCache> cache, NodeShare share)
        : cache_(std::move(cache)), share_(share) {}

    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) override;
    std::shared_ptr<const void> reserve(std::uint64_t bytes) override { return cache_->reserve(bytes); }
    BlockCacheStats stats() const override { return cache_->stats(); }
    void stop() override { cache_->stop(); }

    /// This cloud, of which drawings know the octree's source, is that of its revision's file.
    void know(const Cloud& cloud);
    /// nullopt: it is no cloud file's, or not shared.
    std::optional<CloudPlace> placeOf(std::uint64_t source) const;

  private:
    const std::shared_ptr<BlockCache> cache_;
    const NodeShare share_;
    mutable std::mutex mutex_;
    std::unordered_map<std::string, std::string> paths_;        // by revision
    std::unordered_map<std::uint64_t, std::string> revisions_;  // by source
};

class OpenedClouds {
  public:
    OpenedClouds(std::shared_ptr<BlockCache> cache, NodeShare share)
        : cache_(std::move(cache)), share_(share) {}

    /// The share's samples of all cuts, in memory as long as the drawing lives. Waits for them. Errors: openCloud()'s; InvalidArgument where
    /// the file is another than rank 0's; the block's, where one is damaged.
    Expected<void> provide(UnpackedDrawing& drawing);

  private:
    Expected<std::shared_ptr<const Cloud>> find(const CloudPlace& place);

    const std::shared_ptr<BlockCache> cache_;
    const NodeShare share_;
    std::unordered_map<std::string, std::shared_ptr<const Cloud>> clouds_;  // by path
};

}  // namespace scancast
