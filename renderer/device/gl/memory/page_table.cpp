#include "renderer/device/gl/memory/page_table.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

#include "renderer/cloud/sample.hpp"

namespace scancast::gl {

// ---- Holes

Holes::Holes(std::span<const std::uint32_t> pageGrains) {
    std::uint32_t at = 0;
    for (const std::uint32_t grains : pageGrains) {
        pageStarts_.insert(at);
        add({at, grains});
        at += grains;
    }
}

void Holes::add(Hole hole) {
    byPlace_.emplace(hole.at, hole.length);
    bySize_.emplace(hole.length, hole.at);
    free_ += hole.length;
}

void Holes::remove(std::map<std::uint32_t, std::uint32_t>::iterator hole) {
    free_ -= hole->second;
    bySize_.erase({hole->second, hole->first});
    byPlace_.erase(hole);
}

Holes::Hole Holes::take(std::uint32_t length) {
    assert(free_ > 0 && length > 0);
    auto best = bySize_.lower_bound({length, 0});
    if (best == bySize_.end()) --best;
    const Hole whole{best->second, best->first};
    remove(byPlace_.find(whole.at));
    const Hole taken{whole.at, std::min(length, whole.length)};
    if (taken.length < whole.length) add({whole.at + taken.length, whole.length - taken.length});
    return taken;
}

void Holes::give(Hole hole) {
    const auto next = byPlace_.upper_bound(hole.at);
    if (next != byPlace_.begin() && !pageStarts_.contains(hole.at)) {
        const auto before = std::prev(next);
        if (before->first + before->second == hole.at) {
            hole = {before->first, before->second + hole.length};
            remove(before);
        }
    }
    const std::uint32_t end = hole.at + hole.length;
    if (next != byPlace_.end() && next->first == end && !pageStarts_.contains(end)) {
        hole.length += next->second;
        remove(next);
    }
    add(hole);
}

void Holes::drop(std::uint32_t from, std::uint32_t end) {
    for (auto hole = byPlace_.lower_bound(from); hole != byPlace_.end() && hole->first < end;) {
        const auto dropped = hole++;
        remove(dropped);
    }
}

// ---- KeyIndex

std::size_t KeyIndex::KeyHash::operator()(const SampleKey& key) const {
    // Multiplied by odd constants, so that neighbouring nodes spread.
    std::uint64_t mixed = key.source * 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ key.run) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ key.first) * 0x94d049bb133111ebu;
    return static_cast<std::size_t>(mixed ^ (mixed >> 31));
}

const KeyIndex::Source* KeyIndex::sourceOf(std::uint64_t id) const {
    if (last_ == nullptr || id != lastId_) {
        const auto found = sources_.find(id);
        if (found == sources_.end()) return nullptr;
        lastId_ = id;
        last_ = &found->second;
    }
    return last_;
}

std::uint32_t KeyIndex::find(const SampleKey& key) const {
    if (key.first != 0) {
        const auto found = laterParts_.find(key);
        return found == laterParts_.end() ? none : found->second;
    }
    const Source* const source = sourceOf(key.source);
    return source != nullptr && key.run < source->byRun.size() ? source->byRun[key.run] : none;
}

void KeyIndex::add(const SampleKey& key, std::uint32_t number) {
    assert(find(key) == none);
    if (key.first != 0) {
        laterParts_.emplace(key, number);
        return;
    }
    Source& source = sources_[key.source];
    if (source.byRun.size() <= key.run) source.byRun.resize(std::size_t{key.run} + 1, none);
    source.byRun[key.run] = number;
    ++source.known;
}

void KeyIndex::remove(const SampleKey& key) {
    assert(find(key) != none);
    if (key.first != 0) {
        laterParts_.erase(key);
        return;
    }
    const auto source = sources_.find(key.source);
    source->second.byRun[key.run] = none;
    if (--source->second.known > 0) return;
    last_ = nullptr;
    sources_.erase(source);
}

// ---- PageTable

namespace {

std::vector<std::uint32_t> grainsOf(const std::vector<std::uint32_t>& pageSamples) {
    std::vector<std::uint32_t> grains;
    for (const std::uint32_t samples : pageSamples) grains.push_back(samples / PageTable::grain);
    return grains;
}

}  // namespace

std::vector<std::uint32_t> pageSizes(std::uint64_t limit, std::uint64_t first, std::uint64_t most) {
    constexpr std::uint64_t grainBytes = PageTable::grain * sizeof(Sample);
    const auto whole = [](std::uint64_t bytes) { return std::max(bytes / grainBytes, std::uint64_t(1)); };
    std::uint64_t left = whole(limit), next = std::min(whole(first), whole(most));
    std::vector<std::uint32_t> pages;
    while (left > 0) {
        const std::uint64_t grains = std::min(left, next);
        pages.push_back(static_cast<std::uint32_t>(grains * PageTable::grain));
        left -= grains;
        next = std::min(2 * next, whole(most));
    }
    return pages;
}

PageTable::PageTable(const std::vector<std::uint32_t>& pageSamples)
    : pageGrains_(grainsOf(pageSamples)), holes_(pageGrains_) {
    for (const std::uint32_t grains : pageGrains_) {
        pageStarts_.push_back(static_cast<std::uint32_t>(grains_));
        grains_ += grains;
    }
}

void PageTable::link(std::uint32_t number) {
    Entry& entry = entries_[number];
    entry.newer = KeyIndex::none;
    entry.older = newest_;
    (newest_ == KeyIndex::none ? oldest_ : entries_[newest_].newer) = number;
    newest_ = number;
}

void PageTable::unlink(std::uint32_t number) {
    const Entry& entry = entries_[number];
    (entry.newer == KeyIndex::none ? newest_ : entries_[entry.newer].older) = entry.older;
    (entry.older == KeyIndex::none ? oldest_ : entries_[entry.older].newer) = entry.newer;
}

void PageTable::use(std::uint32_t number) {
    if (number == newest_) return;
    ++uses_;
    unlink(number);
    link(number);
}

std::uint32_t PageTable::newEntry(const SampleKey& key) {
    if (unused_.empty()) {
        unused_.push_back(static_cast<std::uint32_t>(entries_.size()));
        entries_.emplace_back();
        unused_.reserve(entries_.size());  // remove() is called where memory may have run out
    }
    const std::uint32_t number = unused_.back();
    index_.add(key, number);
    unused_.pop_back();
    entries_[number].key = key;
    entries_[number].batch = batch_;
    ++uses_;
    link(number);
    return number;
}

bool PageTable::touch(const SampleKey& key) {
    const std::uint32_t number = index_.find(key);
    if (number == KeyIndex::none) return false;
    use(number);
    return true;
}

std::span<const Place> PageTable::need(const SampleKey& key) {
    const std::uint32_t number = index_.find(key);
    if (number == KeyIndex::none) return {};
    use(number);
    entries_[number].batch = batch_;
    return entries_[number].places;
}

std::uint64_t PageTable::texels(const SampleKey& key) const {
    const std::uint32_t number = index_.find(key);
    std::uint64_t count = 0;
    if (number != KeyIndex::none)
        for (const Place& place : entries_[number].places) count += place.count;
    return count;
}

std::span<const Place> PageTable::insert(const SampleKey& key, std::uint32_t count) {
    assert(count > 0);
    if (const std::uint32_t old = index_.find(key); old != KeyIndex::none) {
        // Whoever knows its places learns that they are no longer true.
        remove(old);
        ++evicted_;
    }
    const std::uint32_t wanted = (count + grain - 1) / grain;
    while (holes_.free() < wanted) {
        // Whatever the batch needs was touched last.
        if (oldest_ == KeyIndex::none || entries_[oldest_].batch == batch_) return {};
        remove(oldest_);
        ++evicted_;
    }
    Entry& entry = entries_[newEntry(key)];
    for (std::uint32_t grains = wanted; grains > 0;) {
        const Holes::Hole hole = holes_.take(grains);
        entry.places.push_back(placeOf(hole));
        grains -= hole.length;
    }
    entry.places.back().count -= wanted * grain - count;
    return entry.places;
}

void PageTable::erase(const SampleKey& key) {
    const std::uint32_t number = index_.find(key);
    if (number != KeyIndex::none) remove(number);
}

void PageTable::close(std::uint32_t page) {
    for (std::uint32_t number = newest_; number != KeyIndex::none;) {
        const std::uint32_t next = entries_[number].older;
        const auto& places = entries_[number].places;
        if (std::ranges::any_of(places, [&](const Place& place) { return place.page == page; })) {
            remove(number);
            ++evicted_;
        }
        number = next;
    }
    holes_.drop(pageStarts_[page], pageStarts_[page] + pageGrains_[page]);
    grains_ -= pageGrains_[page];
    pageGrains_[page] = 0;
}

Place PageTable::placeOf(const Holes::Hole& hole) const {
    const auto page = std::prev(std::ranges::upper_bound(pageStarts_, hole.at));
    return {static_cast<std::uint32_t>(page - pageStarts_.begin()), (hole.at - *page) * grain,
            hole.length * grain};
}

void PageTable::remove(std::uint32_t number) {
    Entry& entry = entries_[number];
    for (const Place& place : entry.places)
        holes_.give({pageStarts_[place.page] + place.at / grain, (place.count + grain - 1) / grain});
    entry.places.clear();
    index_.remove(entry.key);
    unlink(number);
    unused_.push_back(number);
}

}  // namespace scancast::gl
