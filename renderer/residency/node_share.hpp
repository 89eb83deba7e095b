// Which nodes are whose, where several processes draw a cloud together, each with the samples of its share alone; and a
// cloud's samples seen that way. Pipeline: cloud file → block cache → **share** → provide() → device.
//
// *Thread safety*: plain values, and stores as thread-safe as those that they share.
#pragma once

#include <cstdint>
#include <memory>

#include "renderer/cloud/sample_store.hpp"
#include "renderer/residency/block_cache.hpp"

namespace scancast {

struct NodeShare {
    std::uint32_t number = 0;  ///< 0 … of - 1
    std::uint32_t of = 1;

    /// By a hash, so that of whatever a view shows everybody has about as much: siblings are far apart.
    bool has(std::uint32_t node) const {
        std::uint64_t x = (node + 1) * 0x9e3779b97f4a7c15u;
        x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
        x = (x ^ x >> 27) * 0x94d049bb133111ebu;
        return (x >> 32) * of >> 32 == number;
    }
};

/// What is provided for pictures - find(), findAll(), loadAll(), request() - of nodes that are others' is nothing, at once
/// and without memory; load(), which picking asks, gives every node's samples. Its capacity is that of all shares together.
std::shared_ptr<SampleStore> sharedStore(std::shared_ptr<SampleStore> whole, NodeShare share);

/// The cache's clouds by such stores.
std::shared_ptr<BlockCache> sharedCache(std::shared_ptr<BlockCache> cache, NodeShare share);

}  // namespace scancast
