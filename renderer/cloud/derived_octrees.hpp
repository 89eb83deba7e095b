// Octrees that are made of another one's samples for what views ask - coloured and filtered by columns -, so that all views that
// ask the same share one. The few that were used last are kept, by what was asked, as long as the samples that they are made
// of; who draws one holds it himself. Owned by a SampleStore.
//
// *Thread safety*: every function may be called from any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace scancast {

class Octree;
class SampleStore;
class CloudFile;

class DerivedOctrees {
  public:
    /// A slider that is dragged makes one a step; a few views look at a cloud at once.
    static constexpr std::size_t mostKept = 6;
    /// A store for a file's blocks within the memory that this octree's own are in.
    using StoreMaker = std::function<std::shared_ptr<SampleStore>(std::shared_ptr<const CloudFile>)>;

    /// What was kept under these words; null: nothing, any more.
    std::shared_ptr<const Octree> find(const std::string& words);
    /// Keeps it, unless somebody else was first; returns what is kept then.
    std::shared_ptr<const Octree> keep(const std::string& words, std::shared_ptr<const Octree> octree);

    /// Of whoever holds the memory: the block cache, or who counts a cloud in memory. Before others know of the store.
    void setStoreMaker(StoreMaker maker) { maker_ = std::move(maker); }
    /// nullptr: nobody said where.
    std::shared_ptr<SampleStore> storeFor(std::shared_ptr<const CloudFile> file) const;

  private:
    using Kept = std::pair<std::string, std::shared_ptr<const Octree>>;
    std::shared_ptr<const Octree> use(const std::string& words);

    std::mutex guard_;
    std::list<Kept> kept_;  ///< used last, first
    StoreMaker maker_;
};

}  // namespace scancast
