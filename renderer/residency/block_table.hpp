// Which blocks are in memory, how much they take, and which goes first when room is needed: least recently
// used out, but never one that somebody holds, nor the pinned top of a cloud. No threads and no files: the
// block cache uses it under its lock. Place: cloud file → **block table** → sample stores.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

/// Bytes of all that is alive, shared with the blocks: those may outlive the cache in a picture's hands.
using MemoryMeter = std::shared_ptr<std::atomic<std::uint64_t>>;

/// Memory that is counted as long as this lives.
class Block {
  public:
    Block(MemoryMeter meter, std::uint64_t bytes) : meter_(std::move(meter)), bytes_(bytes) {
        *meter_ += bytes;
    }
    ~Block() { *meter_ -= bytes_; }
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

    std::uint64_t bytes() const { return bytes_; }
    std::vector<Sample> samples;
    std::vector<SampleLimits> limits;
    std::vector<BesideWord> beside;  ///< empty: not known

  private:
    MemoryMeter meter_;
    const std::uint64_t bytes_;
};

enum class BlockState : std::uint8_t { Absent, Loading, Resident, Damaged };

class BlockTable {
  public:
    using Time = std::int64_t;  ///< ms of any clock that does not go backwards

    struct CloudBlocks;
    struct Place {
        CloudBlocks* cloud;
        std::uint32_t node;
    };
    struct Slot {
        std::shared_ptr<const Block> block;
        std::list<Place>::iterator place;  // in order_, when resident and not pinned
        Time usedAt = -1;
        BlockState state = BlockState::Absent;
        bool pinned = false;
    };
    struct Damage {
        Error error;
        Time at;
        Time toldAt;
    };
    struct CloudBlocks {
        std::uint64_t id = 0;
        std::shared_ptr<const CloudFile> file;
        std::optional<std::size_t> curvaturePlane, nearInfraredPlane;  // of the file's planes
        std::vector<Slot> slots;                                       // by node
        std::unordered_map<std::uint32_t, Damage> damage;
        std::atomic<std::uint64_t> bytes{0};  // resident blocks
        bool removed = false;
        bool isRemote = false;

        bool hasBeside() const { return curvaturePlane || nearInfraredPlane; }
    };

    /// Memory in use stays below `limit`, but for what is held and what must be loaded nevertheless.
    BlockTable(std::uint64_t limit, Time grace)
        : limit_(limit), grace_(grace), meter_(std::make_shared<std::atomic<std::uint64_t>>(0)) {}

    /// Blocks from the root on, in breadth-first order, are pinned while they fit `pinnedBytes`; the root
    /// always.
    std::shared_ptr<CloudBlocks> add(std::shared_ptr<const CloudFile> file, std::uint64_t pinnedBytes);
    void remove(CloudBlocks& cloud);
    std::shared_ptr<CloudBlocks> find(std::uint64_t id) const;

    /// The block, if it is here; it and its ancestors count as used.
    std::shared_ptr<const Block> use(CloudBlocks& cloud, std::uint32_t node, Time now);
    BlockState state(CloudBlocks& cloud, std::uint32_t node, Time now);
    /// It could not be read, and only for now: what it comes from cannot be reached.
    bool isAway(const CloudBlocks& cloud, std::uint32_t node) const;

    /// Room for a node's samples, which is Loading from then on. nullptr when there is none without what was
    /// used within the grace time; with `must` there always is.
    std::shared_ptr<Block> beginLoad(CloudBlocks& cloud, std::uint32_t node, bool must, Time now);
    void finishLoad(CloudBlocks& cloud, std::uint32_t node, std::shared_ptr<const Block> block, Time now);
    /// Whether somebody should be told: the first time, and where it is tried again, once an hour; never of what is away.
    bool failLoad(CloudBlocks& cloud, std::uint32_t node, Error error, Time now);
    // An exception in these three leaves everything as it was; in failLoad() the node is Absent.

    /// Its own, and what stands beside it.
    static std::uint64_t bytesPerSample(const CloudBlocks& cloud) {
        return sizeof(Sample) + (cloud.hasBeside() ? sizeof(BesideWord) : 0);
    }
    static std::uint64_t bytesOf(const CloudBlocks& cloud, std::uint32_t node) {
        return bytesFor(cloud, cloud.file->nodes()[node].node.sampleCount);
    }
    static std::uint64_t bytesFor(const CloudBlocks& cloud, std::uint64_t samples) {
        return samples * bytesPerSample(cloud) + limitsBytes(samples) + blockOverhead;
    }

    std::uint64_t limit() const { return limit_; }
    std::uint64_t bytes() const { return *meter_; }
    std::uint64_t evicted() const { return evicted_; }
    std::uint64_t pinnedBytes() const { return pinnedBytes_; }
    const MemoryMeter& meter() const { return meter_; }

  private:
    static constexpr std::uint64_t blockOverhead = 128;
    static constexpr Time retryAfter = 5000;  // what the operating system refused may work later
    static constexpr Time askAgain = 500;     // what is away fails at once as long as it is
    static constexpr Time toldAgain = 60 * 60 * 1000;

    bool evictOne(bool must, Time now);
    void touch(CloudBlocks& cloud, std::uint32_t node, Time now);

    const std::uint64_t limit_;
    const Time grace_;
    const MemoryMeter meter_;
    std::map<std::uint64_t, std::shared_ptr<CloudBlocks>> clouds_;
    std::list<Place> order_;  // most recently used first
    std::uint64_t lastId_ = 0;
    std::uint64_t pinnedBytes_ = 0;
    std::uint64_t evicted_ = 0;
};

}  // namespace scancast
