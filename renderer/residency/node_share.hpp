// Which nodes are whose, where several processes draw a cloud together, each with the samples of its share alone; and a
// cloud's samples seen that way. Pipeline: cloud file → block cache → **share** → provide() → device.
//
// *Thread safety*: plain values, and stores as thread-safe as those that they share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/cloud/sample_store.hpp"

namespace scancast {

struct NodeShare {
    std::uint32_t number = 0;  ///< 0 … of - 1
    std::uint32_t of = 1;

    /// In turn, so that siblings, and whatever a view shows, are shared out more evenly than by chance; each 64 nodes the turn is
    /// another, should only every second child have anything in it.
    bool has(std::uint32_t node) const { return (node + node / 64) % of == number; }
};

/// Which cloud file, and where everybody finds it.
struct CloudPlace {
    std::string path, revision;
};

/// What is provided for pictures - find(), findAll(), loadAll(), request() - of nodes that are others' is nothing, at once
/// and without memory; load(), which picking asks, gives every node's samples. Its capacity is that of all shares together.
/// Whoever opens the file again has another store: what is shared is this one, not all that is of its revision.
std::shared_ptr<SampleStore> sharedStore(std::shared_ptr<SampleStore> whole, NodeShare share,
                                         std::shared_ptr<const CloudPlace> place);

/// Of a store that is such a one, what it was made of; null: it is another, and has all samples.
std::shared_ptr<const CloudPlace> placeOfShared(const SampleStore& store);

}  // namespace scancast
