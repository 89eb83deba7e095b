// Blocks that somebody waits for, and how far they are. Owned by the waiting thread, registered in the block
// cache while it waits, used under the cache's lock.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "renderer/residency/block_table.hpp"

namespace scancast {

class Demand {
  public:
    using Answer = std::optional<Expected<std::shared_ptr<const Block>>>;

    Demand(BlockTable::CloudBlocks& cloud, std::span<const std::uint32_t> nodes) : cloud_(cloud) {
        for (const std::uint32_t node : nodes)
            if (answers_.try_emplace(node).second) toLoad_.push_back(node);
        open_ = toLoad_.size();
    }

    BlockTable::CloudBlocks& cloud() const { return cloud_; }
    bool complete() const { return open_ == 0; }
    bool hasWork() const { return next_ < toLoad_.size(); }
    /// A node that nobody has looked at for this demand. Expects hasWork().
    std::uint32_t takeNode() { return toLoad_[next_++]; }
    /// The first answer counts; other clouds' and unwanted nodes' are none.
    void answer(const BlockTable::CloudBlocks& cloud, std::uint32_t node,
                const Expected<std::shared_ptr<const Block>>& result) {
        if (&cloud != &cloud_) return;
        const auto at = answers_.find(node);
        if (at == answers_.end() || at->second) return;
        try {
            at->second = result;
        } catch (...) {  // no memory for the sentence; the answer must come nevertheless
            at->second = tl::unexpected(Error{ErrorCode::ResourceLimit, "Out of memory.", {}});
        }
        --open_;
    }
    const Answer& answerTo(std::uint32_t node) const { return answers_.at(node); }

  private:
    BlockTable::CloudBlocks& cloud_;
    std::unordered_map<std::uint32_t, Answer> answers_;
    std::vector<std::uint32_t> toLoad_;
    std::size_t next_ = 0, open_ = 0;
};

}  // namespace scancast
