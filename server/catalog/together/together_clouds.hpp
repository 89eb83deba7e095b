// Clouds that views show together, made when somebody asks for them and kept while they are asked for: a bounded number, the one
// that nobody has asked for longest goes first. A cloud that is replaced or removed takes those with it that it is in.
//
// Owned by the catalog. *Thread safety*: any thread; nobody waits while one is made, which takes milliseconds.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "renderer/together/together.hpp"

namespace scancast {

class TogetherClouds {
  public:
    static constexpr std::size_t most = 16;
    /// Of all that are kept, so that many large ones are fewer.
    static constexpr std::uint64_t mostNodes = 2 * mostNodesTogether;

    /// Where tinted samples are kept, and all of it is counted. Without one there is a small one of its own.
    void setCache(std::shared_ptr<BlockCache> cache);
    /// The same one for the same clouds in the same places. Errors: putTogether()'s.
    Expected<std::shared_ptr<const Cloud>> of(std::vector<TogetherMember> members, bool byCloud);
    using Clouds = std::list<std::shared_ptr<const Cloud>>;
    /// Forgets those that it is in; who looks at one goes on looking. They take their time to go, which who holds a lock leaves for
    /// later.
    [[nodiscard]] Clouds forget(const Cloud* member);
    std::size_t size() const;

  private:
    mutable std::mutex mutex_;
    std::shared_ptr<BlockCache> cache_;
    std::shared_ptr<const Cloud> find(const std::vector<TogetherMember>& members, bool byCloud);

    Clouds clouds_;  ///< most recently asked for first
};

}  // namespace scancast
