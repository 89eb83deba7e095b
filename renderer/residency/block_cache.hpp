// The memory that blocks of cloud files live in: one limit for all clouds of a process, loader threads, least
// recently used out. Place: cloud file → **block cache** → sample stores → provide().
//
// Owned by its stores and whoever made it, together. *Thread safety*: every function may be called from any
// thread; onDamaged is called from whichever thread read the block.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/sample_store.hpp"

namespace scancast {

struct BlockCacheOptions {
    std::uint64_t memoryLimit = 0;  ///< bytes, of everything: blocks, nodes, what reserve() was told
    int threads = 2;                ///< that read files of this machine
    /// That read files which come over a network, where there are any. They wait, mostly: what they wait for at once is what
    /// arrives within the network's latency.
    int remoteThreads = 24;
    /// A block that a picture used so recently makes room only for what somebody waits for: two views that do
    /// not fit together then stay coarse instead of driving each other out.
    std::chrono::milliseconds grace{250};
    /// Called for each block that cannot be read, once: where it is tried again and again, once an hour.
    std::function<void(const std::shared_ptr<const CloudFile>&, const Error&)> onDamaged;
};

struct BlockCacheStats {
    std::uint64_t limit = 0;
    std::uint64_t bytes = 0;  ///< of everything that counts against the limit, pictures' own included
    std::uint64_t blocksLoaded = 0, blocksEvicted = 0, blocksDamaged = 0;
    std::uint64_t requests = 0;  ///< waiting now
};

class BlockCache {
  public:
    static std::shared_ptr<BlockCache> create(const BlockCacheOptions& options);
    /// Stops the threads: after the block that each is reading.
    virtual ~BlockCache() = default;

    /// A cloud file's samples, by node. Its upper levels stay in memory once they are there, a few MB of
    /// them.
    virtual std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) = 0;
    /// The same for what is made of a cloud's samples for a view: of that only the root stays, and takes nothing from what clouds keep.
    virtual std::shared_ptr<SampleStore> addDerived(std::shared_ptr<const CloudFile> file) {
        return add(std::move(file));
    }
    /// Counts memory that something else takes, as long as the result lives.
    virtual std::shared_ptr<const void> reserve(std::uint64_t bytes) = 0;
    virtual BlockCacheStats stats() const = 0;
    /// Ends every wait with Cancelled and loads nothing more.
    virtual void stop() = 0;
};

}  // namespace scancast
