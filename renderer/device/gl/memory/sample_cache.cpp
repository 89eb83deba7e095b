#include "renderer/device/gl/memory/sample_cache.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace scancast::gl {

namespace {

constexpr std::uint64_t stagingBytes = std::uint64_t(32) << 20;

/// A word beside a sample is found by a number of 32 bits in its page, and its texel by one of 31.
constexpr std::uint64_t addressableBytes = std::uint64_t(2) << 30;

std::uint64_t mostPageBytes(const GlFunctions& gl, std::uint64_t largest) {
    return std::min({largest, addressableBytes, std::uint64_t{mostTexels(gl)} * sizeof(Sample)});
}

constexpr std::uint32_t besidePerTexel = sizeof(Sample) / sizeof(BesideWord);
/// Of a grain's texels, where words stand beside them.
constexpr std::uint32_t withBesidePerGrain = PageTable::grain * besidePerTexel / (besidePerTexel + 1);

std::uint32_t besideTexels(std::uint32_t samples) {
    return (samples + besidePerTexel - 1) / besidePerTexel;
}

/// That so many samples take; how ever they are dealt out to places, whole grains are filled alike.
std::uint32_t texelsOf(std::uint32_t samples, bool beside) {
    if (!beside) return samples;
    const std::uint32_t rest = samples % withBesidePerGrain;
    return samples / withBesidePerGrain * PageTable::grain + rest + besideTexels(rest);
}

/// What a place of these holds of them.
std::uint32_t samplesIn(const Place& place, bool beside) {
    if (!beside) return place.count;
    const std::uint32_t rest = place.count % PageTable::grain;
    return place.count / PageTable::grain * withBesidePerGrain + rest * besidePerTexel / (besidePerTexel + 1);
}

/// Of a small memory, no node takes more than a part: pages are then never full of one node alone. With the
/// words beside them a part fits, too.
std::uint32_t mostInPart(std::uint64_t capacity) {
    if (capacity < 2 * PageTable::grain) return withBesidePerGrain;
    const std::uint64_t grains = std::clamp<std::uint64_t>(capacity / 4 / PageTable::grain, 1, 1 << 20);
    return static_cast<std::uint32_t>(grains) * PageTable::grain;
}

std::uint64_t texelsIn(std::span<const Place> places) {
    std::uint64_t texels = 0;
    for (const Place& place : places) texels += place.count;
    return texels;
}

tl::unexpected<Error> cancelled() {
    return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
}

}  // namespace

// ---- SampleCache

SampleCache::SampleCache(const GlFunctions& gl, const SampleCacheOptions& options)
    : gl_(gl),
      table_(pageSizes(options.memoryLimit, options.firstPage, mostPageBytes(gl, options.largestPage))),
      mostInPart_(mostInPart(table_.capacity())),
      pages_(table_.pages()),
      staging_(gl, std::clamp<std::uint64_t>(options.memoryLimit / 4, 64 << 10, stagingBytes)) {}

bool SampleCache::has(std::uint64_t source, std::uint32_t node, std::uint32_t samples, bool beside) const {
    for (std::uint32_t first = 0; first < samples; first += mostInPart_) {
        const std::uint32_t inPart = std::min(mostInPart_, samples - first);
        if (table_.texels({source, node, first}) < texelsOf(inPart, beside)) return false;
    }
    return true;
}

void SampleCache::addParts(const SampleKey& key, std::uint32_t run, const CutRun& from,
                           std::vector<Part>& parts) const {
    for (std::size_t first = 0; first < from.samples.size(); first += mostInPart_) {
        const std::size_t count = std::min<std::size_t>(mostInPart_, from.samples.size() - first);
        Part part{{key.source, key.run, static_cast<std::uint32_t>(first)},
                  run,
                  from.samples.subspan(first, count),
                  {}};
        if (!from.beside.empty()) part.beside = from.beside.subspan(first, count);
        parts.push_back(part);
    }
}

void SampleCache::touch(std::span<const Part> parts) {
    // The last first: of parts that do not all fit, those that are needed first stay longest.
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) table_.touch(part->key);
    table_.beginBatch();
}

Expected<void> SampleCache::bring(std::uint64_t source, std::span<const CutRun> runs,
                                  const std::stop_token& stop) {
    std::vector<Part> parts;
    for (std::uint32_t i = 0; i < runs.size(); ++i)
        addParts({source, runs[i].nodeIndex, 0}, i, runs[i], parts);
    touch(parts);
    for (const Part& part : parts) {
        if (stop.stop_requested()) return cancelled();
        const auto loaded = load(part);
        if (!loaded) return passOn(loaded);
        if (loaded->empty()) break;
    }
    return {};
}

Expected<std::span<const Place>> SampleCache::load(const Part& part) {
    const auto samples = static_cast<std::uint32_t>(part.samples.size());
    const std::uint32_t texels = texelsOf(samples, !part.beside.empty());
    auto places = table_.need(part.key);
    // One with words beside them holds more texels than samples, and serves both.
    if (const std::uint64_t there = texelsIn(places); there == texels || there == texelsOf(samples, true))
        return places;
    while (true) {
        places = table_.insert(part.key, texels);
        if (places.empty()) return places;
        const auto made = makePages(places);
        if (!made) table_.erase(part.key);
        if (!made) return passOn(made);
        if (*made) break;
    }
    if (auto uploaded = upload(places, part); !uploaded) {
        table_.erase(part.key);
        return passOn(uploaded);
    }
    return places;
}

Expected<bool> SampleCache::makePages(std::span<const Place> places) {
    for (const Place& place : places) {
        if (pages_[place.page]) continue;
        Buffer buffer(gl_, "page of samples", Buffer::Use::Copies);
        const std::uint64_t bytes = std::uint64_t(table_.pageSamples(place.page)) * sizeof(Sample);
        const auto made = buffer.reserve(bytes);
        if (!made && made.error().code != ErrorCode::ResourceLimit) return passOn(made);
        if (!made) {
            spdlog::warn("{} Samples get less of it than --gpu-memory-limit says.", made.error().message);
            table_.close(place.page);
            return false;
        }
        Texels texels(gl_, buffer, sizeof(Sample) / 4);
        pages_[place.page].emplace(std::move(buffer), std::move(texels));
        bytes_ += bytes;
    }
    return true;
}

template <class T>
Expected<void> SampleCache::copy(std::span<const T> values, std::uint32_t page, std::uint32_t texel) {
    bytesUploaded_ += values.size_bytes();
    return staging_.copy(std::as_bytes(values), pages_[page]->buffer, texel * sizeof(Sample));
}

Expected<void> SampleCache::upload(std::span<const Place> places, const Part& part) {
    const bool beside = !part.beside.empty();
    std::size_t first = 0;
    for (const Place& place : places) {
        const std::uint32_t count = samplesIn(place, beside);
        if (auto ok = copy(part.samples.subspan(first, count), place.page, place.at); !ok) return ok;
        if (beside)
            if (auto ok = copy(part.beside.subspan(first, count), place.page, place.at + count); !ok)
                return ok;
        first += count;
    }
    return {};
}

// ---- CutSamples

CutSamples::CutSamples(SampleCache& cache, const Cut& cut, std::span<const std::uint32_t> runs)
    : cache_(cache), extents_(cache.pages_.size()), passing_(cut.source == 0) {
    const std::uint64_t source = passing_ ? newSource() : cut.source;
    parts_.reserve(runs.size());
    for (const std::uint32_t run : runs) {
        const std::uint32_t key = passing_ ? run : cut.runs[run].nodeIndex;
        cache.addParts({source, key, 0}, run, cut.runs[run], parts_);
    }
}

CutSamples::~CutSamples() {
    if (!passing_) return;
    for (const SampleCache::Part& part : parts_) cache_.table_.erase(part.key);
}

void CutSamples::again() {
    if (uses_ == cache_.table_.uses()) return;
    cache_.touch(parts_);
    uses_ = cache_.table_.uses();
}

Expected<SampleBatch> CutSamples::gather(const std::stop_token& stop) {
    const bool asItWas = gathered_ > 0 && evicted_ == cache_.table_.evicted();
    if (!asItWas && !parts_.empty()) {
        whole_ = false;
        cache_.touch(parts_);
        const auto end = loadBatch(0, stop);
        if (!end) return passOn(end);
        gathered_ = *end;
        whole_ = gathered_ == parts_.size();
        evicted_ = cache_.table_.evicted();
        uses_ = cache_.table_.uses();
    }
    return SampleBatch{batchPages_, version_};
}

Expected<void> CutSamples::forEachBatch(const Draw& draw, const std::stop_token& stop) {
    const auto first = gather(stop);
    if (!first) return passOn(first);
    if (parts_.empty()) return {};
    if (auto drawn = draw(*first); !drawn || whole_) return drawn;
    for (std::size_t from = std::exchange(gathered_, 0); from < parts_.size();) {
        const auto end = loadBatch(from, stop);
        if (!end) return passOn(end);
        if (auto ok = draw({batchPages_, version_}); !ok) return ok;
        from = *end;
    }
    // The next round begins with what is here.
    std::ranges::reverse(parts_);
    return {};
}

Expected<std::size_t> CutSamples::loadBatch(std::size_t from, const std::stop_token& stop) {
    cache_.table_.beginBatch();
    version_ = newSource();
    for (auto& extents : extents_) extents.clear();
    std::size_t at = from;
    for (; at < parts_.size(); ++at) {
        if (stop.stop_requested()) return cancelled();
        const SampleCache::Part& part = parts_[at];
        const auto places = cache_.load(part);
        if (!places) return passOn(places);
        if (places->empty()) break;
        const bool beside = texelsIn(*places) > part.samples.size();
        std::uint32_t first = part.key.first;
        for (const Place& place : *places) {
            const std::uint32_t count = samplesIn(place, beside);
            extents_[place.page].push_back(
                {part.run, first, count, place.at, beside ? (place.at + count) * besidePerTexel : 0});
            first += count;
        }
    }
    if (at == from)
        return fail(ErrorCode::ResourceLimit,
                    "The GPU has no memory left for samples; close other programs that use it, give Scancast "
                    "more by --gpu-memory-limit, or use --backend=cpu.");
    batchPages_.clear();
    for (std::size_t page = 0; page < extents_.size(); ++page) {
        if (extents_[page].empty()) continue;
        batchPages_.push_back({&cache_.pages_[page]->texels, extents_[page]});
    }
    return at;
}

}  // namespace scancast::gl
