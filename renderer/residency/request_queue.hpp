// Who wants which blocks, and whose turn it is. Place: provide → **request queue** → loader threads.
//
// A requester (one session looking at one cloud) has one list, the newest; requesters take turns, so that
// somebody who flies through a city does not starve somebody who looks at a room. Owned by the block cache,
// used under its lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "renderer/cloud/sample_store.hpp"

namespace scancast {

class RequestQueue {
  public:
    static constexpr std::size_t mostRequesters = 4096;
    static constexpr std::size_t mostRequests = 4096;  ///< of one requester

    struct Next {
        std::uint64_t cloud;
        std::uint32_t node;
    };

    /// Takes the place of what this requester asked of this cloud; nothing = it requests no more. Of too many,
    /// the least urgent are left out; of too many requesters, the one who would have waited longest for a
    /// turn.
    void set(std::uint64_t cloud, std::uint64_t requester, std::vector<BlockRequest> requests);
    /// The most urgent request of the requester whose turn it is, which is thereby taken off the list.
    std::optional<Next> next();
    /// The cloud is gone.
    void forget(std::uint64_t cloud);
    bool empty() const { return lists_.empty(); }
    std::size_t size() const;

  private:
    using Requester = std::pair<std::uint64_t, std::uint64_t>;  // cloud, who
    std::map<Requester, std::vector<BlockRequest>> lists_;      // most urgent last; never empty
    std::list<Requester> turns_;                                // the keys of lists_
};

}  // namespace scancast
