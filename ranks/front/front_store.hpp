// A cloud file's samples as a front sees them: while ranks draw it others' nodes are there and take no memory, as in
// renderer/residency/node_share.hpp with a share of nothing; while they do not, it is the file's own store, within the front's
// memory limit. Place: block cache → **front's store** → provide().
//
// *Thread safety*: as every store. What is provided while its RankedFile changes is of both states: who provides looks at
// FrontClouds::changesOf() before and after.
#pragma once

#include <memory>

#include "ranks/front/front_clouds.hpp"
#include "renderer/cloud/sample_store.hpp"

namespace scancast {

class FrontStore final : public SampleStore {
  public:
    FrontStore(std::shared_ptr<SampleStore> whole, std::shared_ptr<const CloudFile> cloud,
               std::shared_ptr<RankedFile> file, std::shared_ptr<const FrontClouds> clouds)
        : whole_(std::move(whole)),
          cloud_(std::move(cloud)),
          file_(std::move(file)),
          clouds_(std::move(clouds)) {}

    const RankedFile& file() const { return *file_; }

    std::optional<SampleRun> find(std::uint32_t node) override;
    std::vector<std::optional<SampleRun>> findAll(std::span<const std::uint32_t> nodes) override;
    /// Every node's, whoever draws: picking asks.
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override;
    /// Unavailable also: without ranks there is no memory for so much, and they have not come back in time; or they have come back
    /// meanwhile, and what was asked for is theirs to load.
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override;
    void request(std::uint64_t requester, std::vector<BlockRequest> requests) override;
    bool whole() const override { return whole_->whole(); }
    bool damaged(std::uint32_t node) const override { return !byRanks() && whole_->damaged(node); }
    /// Without the ranks what is missing is coarser until they are back, or until the front's memory holds it.
    bool isAway() const override {
        return (file_->by == DrawnBy::FrontMeanwhile && isMoreThanFronts()) || whole_->isAway();
    }
    /// All ranks', once it is known, whether they are there or not: a picture's samples do not depend on that.
    std::uint64_t capacity() const override;
    std::uint64_t bytesResident() const override { return whole_->bytesResident(); }
    std::shared_ptr<const CloudFile> cloudFile() const override { return cloud_; }

  private:
    bool byRanks() const { return file_->by == DrawnBy::Ranks; }
    /// Ranks have had it open, and hold more of it than this process may.
    bool isMoreThanFronts() const;
    std::uint64_t samplesIn(std::span<const std::uint32_t> nodes) const;

    const std::shared_ptr<SampleStore> whole_;
    const std::shared_ptr<const CloudFile> cloud_;
    const std::shared_ptr<RankedFile> file_;
    const std::shared_ptr<const FrontClouds> clouds_;
};

}  // namespace scancast
