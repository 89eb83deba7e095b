// The clouds of a front: of each cloud file that the ranks have opened, nothing but its upper levels, as long as they are there; while
// they are not, what its own memory limit holds, coarser ancestors for the rest. What the ranks cannot open is the front's alone.
//
// *Thread safety*: all functions may be called from any thread. Place: block cache → **front's clouds** → provide() → front's device.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <unordered_map>
#include <vector>

#include "ranks/front/job_keeper.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"
#include "renderer/residency/node_share.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// Who draws a cloud file.
enum class DrawnBy : std::uint8_t {
    Ranks,
    FrontMeanwhile,  ///< they are not there, or have not opened it yet
    FrontAlone,      ///< they cannot open it
};

/// A cloud file that ranks are asked to open.
struct RankedFile {
    RankedFile(std::uint64_t its, CloudPlace where) : number(its), place(std::move(where)) {}

    const std::uint64_t number;
    const CloudPlace place;
    std::atomic<DrawnBy> by{DrawnBy::FrontMeanwhile};
    /// Odd while `by` changes. Who sees the same even number before and after has seen one state all the time.
    std::atomic<std::uint64_t> changes{0};
    std::atomic<std::uint64_t> capacity{0};  ///< of all ranks; 0: not known yet
    bool isAnswered = false;                 ///< by the ranks that are there; under the clouds' lock
    std::stop_source until;                  ///< `by` is something else; likewise
};

class FrontClouds final : public BlockCache,
                          public JobListener,
                          public std::enable_shared_from_this<FrontClouds> {
  public:
    using OnAlone = std::function<void(const std::string&)>;

    /// `onAlone`: told of each cloud that ranks do not draw: which and why. The keeper outlives this, or close() is called first.
    FrontClouds(std::shared_ptr<BlockCache> cache, JobKeeper& keeper, OnAlone onAlone)
        : cache_(std::move(cache)), onAlone_(std::move(onAlone)), keeper_(&keeper) {}

    /// Waits for the ranks' answer, where they are there or just being started, for some seconds.
    std::shared_ptr<SampleStore> add(std::shared_ptr<const CloudFile> file) override;
    std::shared_ptr<const void> reserve(std::uint64_t bytes) override { return cache_->reserve(bytes); }
    BlockCacheStats stats() const override { return cache_->stats(); }
    void stop() override { cache_->stop(); }

    /// Drawings of this cloud may come: they know their octree's source alone.
    void know(const std::shared_ptr<const Cloud>& cloud);
    /// nullopt: the front draws it alone, or it is gone.
    std::optional<CloudPlace> placeOf(std::uint64_t source) const;
    /// Changes whenever somebody else draws this cloud; constant for those that only the front draws. Waits out a change.
    static std::uint64_t changesOf(const Cloud& cloud);
    /// For what ranks alone can draw: whether they do now. Waits for some seconds after they were lost.
    bool waitForRanks(const RankedFile& file, const std::stop_token& stop) const;
    /// Requested when somebody else draws it.
    std::stop_token untilChanged(const RankedFile& file) const;
    /// The keeper is about to go.
    void close();

    void jobIsUp() override;
    void jobOpened(std::uint64_t number, const JobOpened& opened) override;
    void jobIsLost() override;

  private:
    using Clock = std::chrono::steady_clock;
    using Lock = Monitor::Lock;
    struct Known {
        std::weak_ptr<const Cloud> cloud;
        std::optional<CloudPlace> place;
    };

    std::shared_ptr<RankedFile> enlist(CloudPlace place);
    void askToOpen(const RankedFile& file);
    RankBytes wordsFor(const RankedFile& file) const;
    static void change(RankedFile& file, DrawnBy by);

    const std::shared_ptr<BlockCache> cache_;
    const OnAlone onAlone_;
    mutable Monitor monitor_;  // guards what follows
    JobKeeper* keeper_;
    std::map<std::uint64_t, std::weak_ptr<RankedFile>> files_;  // by number
    std::unordered_map<std::uint64_t, Known> known_;            // by source
    std::uint64_t lastNumber_ = 0;
    Clock::time_point lostAt_ = Clock::now();
    bool isUp_ = false;
};

}  // namespace scancast
