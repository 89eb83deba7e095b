// Which samples are where on the GPU: pages of fixed size, places in them, and what goes first when room is
// needed: least recently used out, but nothing that the batch being loaded needs. Bookkeeping alone, no
// OpenGL: the sample cache moves the bytes. Used on the render thread.
//
// Places are multiples of a grain. A run that fits no hole is dealt out to several, so that whatever is free
// can be used, however scattered.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace scancast::gl {

/// Samples of a node, from one on: large nodes are kept in parts.
struct SampleKey {
    std::uint64_t source = 0;  ///< of the cut (renderer/select/select.hpp)
    std::uint32_t run = 0;     ///< the node's index
    std::uint32_t first = 0;   ///< index in the node of the part's first sample
    bool operator==(const SampleKey&) const = default;
};

/// Texels side by side in a page.
struct Place {
    std::uint32_t page = 0;
    std::uint32_t at = 0;     ///< texels from the page's beginning
    std::uint32_t count = 0;  ///< texels
    bool operator==(const Place&) const = default;
};

/// Free grains, none of them across a border of pages. The best fit, else the largest hole.
class Holes {
  public:
    explicit Holes(std::span<const std::uint32_t> pageGrains);
    struct Hole {
        std::uint32_t at = 0, length = 0;  ///< grains, pages counted through
    };
    /// At most `length` grains; expects some to be free.
    Hole take(std::uint32_t length);
    void give(Hole hole);
    /// What is free there is no longer; expects all of it to be.
    void drop(std::uint32_t from, std::uint32_t end);
    std::uint64_t free() const { return free_; }

  private:
    void add(Hole hole);
    void remove(std::map<std::uint32_t, std::uint32_t>::iterator hole);

    std::map<std::uint32_t, std::uint32_t> byPlace_;            // at → length
    std::set<std::pair<std::uint32_t, std::uint32_t>> bySize_;  // length, at
    std::set<std::uint32_t> pageStarts_;
    std::uint64_t free_ = 0;
};

/// From keys to small numbers. The first parts of a source's nodes - nearly all that there are - are looked
/// up by the node's number, without a search: pictures ask for thousands of them.
class KeyIndex {
  public:
    static constexpr std::uint32_t none = 0xffffffff;

    std::uint32_t find(const SampleKey& key) const;
    /// Expects a key that has none.
    void add(const SampleKey& key, std::uint32_t number);
    /// Expects one that has.
    void remove(const SampleKey& key);

  private:
    struct Source {
        std::vector<std::uint32_t> byRun;
        std::size_t known = 0;
    };
    struct KeyHash {
        std::size_t operator()(const SampleKey& key) const;
    };
    const Source* sourceOf(std::uint64_t id) const;

    std::unordered_map<std::uint64_t, Source> sources_;
    mutable std::uint64_t lastId_ = 0;  ///< of the source that was asked for last; pictures are of one
    mutable const Source* last_ = nullptr;
    std::unordered_map<SampleKey, std::uint32_t, KeyHash> laterParts_;
};

/// In samples: the first holds `first` bytes, each next one twice as much as the one before, up to `most`,
/// and all together at most `limit`; at least a grain.
std::vector<std::uint32_t> pageSizes(std::uint64_t limit, std::uint64_t first, std::uint64_t most);

class PageTable {
  public:
    static constexpr std::uint32_t grain = 256;  ///< samples

    /// Sizes of the pages in samples, > 0, rounded down to multiples of a grain.
    explicit PageTable(const std::vector<std::uint32_t>& pageSamples);

    std::uint64_t capacity() const { return grains_ * grain; }  ///< samples
    std::uint64_t used() const { return (grains_ - holes_.free()) * grain; }
    std::uint32_t pages() const { return static_cast<std::uint32_t>(pageGrains_.size()); }
    /// 0: it is closed.
    std::uint32_t pageSamples(std::uint32_t page) const { return pageGrains_[page] * grain; }
    std::uint64_t evicted() const { return evicted_; }  ///< parts, since the beginning
    /// The same number as before: nothing was used since, by anybody.
    std::uint64_t uses() const { return uses_; }

    bool has(const SampleKey& key) const { return index_.find(key) != KeyIndex::none; }
    /// Of what is here, as many as were inserted; 0: it is not here.
    std::uint64_t texels(const SampleKey& key) const;
    /// It goes after everything that was touched before. False: it is not here.
    bool touch(const SampleKey& key);
    /// From now on, nothing is needed. What the batch may need is touched before it needs anything: what it
    /// needs is then the most recently used.
    void beginBatch() { ++batch_; }
    /// The places of what is here, which is needed until beginBatch(). Empty: it is not here.
    std::span<const Place> need(const SampleKey& key);
    /// Makes room for so many texels, and needs it; what was here by this key goes. Empty: everything that is
    /// here is needed. Expects count > 0.
    std::span<const Place> insert(const SampleKey& key, std::uint32_t count);
    /// Does nothing where it is not here.
    void erase(const SampleKey& key);
    /// There is no such page, it turns out: what was to be in it is gone.
    void close(std::uint32_t page);

  private:
    /// One part that is here; between the one used next and the one used before.
    struct Entry {
        SampleKey key;
        std::vector<Place> places;  ///< none: nobody's
        std::uint32_t newer = KeyIndex::none, older = KeyIndex::none;
        std::uint64_t batch = 0;
    };

    Place placeOf(const Holes::Hole& hole) const;
    std::uint32_t newEntry(const SampleKey& key);
    void remove(std::uint32_t number);
    // In the order of use.
    void link(std::uint32_t number);
    void unlink(std::uint32_t number);
    void use(std::uint32_t number);

    std::vector<std::uint32_t> pageGrains_;
    std::vector<std::uint32_t> pageStarts_;  // grains, pages counted through
    std::uint64_t grains_ = 0;
    Holes holes_;
    KeyIndex index_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> unused_;  ///< of entries_
    std::uint32_t newest_ = KeyIndex::none, oldest_ = KeyIndex::none;
    std::uint64_t batch_ = 0, evicted_ = 0, uses_ = 0;
};

}  // namespace scancast::gl
