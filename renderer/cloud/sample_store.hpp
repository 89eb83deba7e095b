// Where an octree's samples are: all in memory, or in a cloud file of which blocks come and go
// (renderer/residency). Pipeline: octree → **sample store** → cut → device.
//
// *Thread safety*: every function may be called from any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/derived_octrees.hpp"
#include "renderer/cloud/sample.hpp"
#include "renderer/cloud/sample_limits.hpp"

namespace scancast {

class CloudFile;
class StoreGate;

/// The samples of one node, in memory as long as this lives.
struct SampleRun {
    std::span<const Sample> samples;
    std::span<const SampleLimits> limits;  ///< of the samples
    std::shared_ptr<const void> keep;
    std::span<const BesideWord> beside{};  ///< of the samples; empty: not known
};

/// A node whose samples somebody would like to have; larger = sooner.
struct BlockRequest {
    std::uint32_t node = 0;
    double urgency = 0;
};

class SampleStore {
  public:
    virtual ~SampleStore() = default;
    /// What is in memory now; never waits. Marks it as used.
    virtual std::optional<SampleRun> find(std::uint32_t node) = 0;
    /// The same for many, in the order asked for: a lock is taken once at most.
    virtual std::vector<std::optional<SampleRun>> findAll(std::span<const std::uint32_t> nodes);
    /// Loads it if need be, and waits for that. Errors: Malformed, Truncated, Io for a damaged block;
    /// Cancelled; Unavailable, where it may be tried again soon.
    virtual Expected<SampleRun> load(std::uint32_t node, std::stop_token stop = {}) = 0;
    /// Loads all of these, several at a time, and waits until every one has its answer, in the order asked
    /// for: its samples or what load() would say. Once `stop` is requested, what is missing is Cancelled.
    virtual std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                                     std::stop_token stop = {}) = 0;
    /// Loads these in the background, most urgent first; takes the place of all earlier requests of the same
    /// requester. Requesters take turns, whatever their urgencies. Never waits.
    virtual void request(std::uint64_t requester, std::vector<BlockRequest> requests) = 0;
    /// Everything is in memory and stays there.
    virtual bool whole() const = 0;
    /// It was tried, and its block cannot be read. What is only Unavailable is not damaged.
    virtual bool damaged(std::uint32_t node) const = 0;
    /// What is not in memory cannot be had at present, because a part of the server is out of reach - storage behind a network,
    /// another process -, and it comes by itself when that is back. Pictures that lack something meanwhile say so
    /// (Cut::away). Never waits.
    virtual bool isAway() const { return false; }
    /// Most samples that one picture may hold on to at once.
    virtual std::uint64_t capacity() const = 0;
    virtual std::uint64_t bytesResident() const = 0;
    /// The cloud file whose samples these are, with everything that it has beside them; empty where there is none.
    virtual std::shared_ptr<const CloudFile> cloudFile() const { return nullptr; }
    /// Octrees that were made of this one's samples for views, kept as long as this lives, those used last.
    DerivedOctrees& derived() { return derived_; }
    /// How what is made of its samples asks for them without keeping it; nullptr: nothing can be made of them, because they are not all
    /// in this process.
    virtual std::shared_ptr<StoreGate> gate() const { return nullptr; }

  private:
    DerivedOctrees derived_;
};

/// A way to a store that does not keep it: what is made of a store's samples is kept by it, and must not keep it in turn - nor be
/// the last to let go of it, on a thread that it owns. Any thread.
class StoreGate {
  public:
    explicit StoreGate(SampleStore& store) : store_(&store) {}

    /// What `use` makes of the store, which lives at least until it returns; `otherwise` once it is gone.
    template <class T, class Use>
    T with(Use use, T otherwise) const {
        const std::shared_lock lock(guard_);
        return store_ == nullptr ? std::move(otherwise) : T(use(*store_));
    }
    /// First thing in the store's destructor: returns when nobody uses it any more.
    void close() {
        const std::unique_lock lock(guard_);
        store_ = nullptr;
    }

  private:
    mutable std::shared_mutex guard_;
    SampleStore* store_;
};

/// Everything in memory: run i is samples[first[i]] … samples[first[i + 1] - 1].
/// So is what stands beside them, unless there is nothing.
std::shared_ptr<SampleStore> memoryStore(std::vector<Sample> samples, std::vector<std::uint64_t> first,
                                         std::vector<BesideWord> beside = {});

}  // namespace scancast
