// Samples on the GPU: nodes' runs in pages of buffers that are read as texels, within a memory limit, least
// recently used out. Where somebody asks for what stands beside them (cloud/sample.hpp), these words stand behind the samples of each place, four
// a texel; who does not ask is served by either kind. Layers ask for the runs of their cut and get them page by page; where a cut does not
// fit, batch by batch, with uploads in between. Place: host blocks → provide() → **sample cache** → layer.
//
// Owned by the GL device; everything, destruction included, on its thread and inside a Current scope of its
// context. Uploads go through a mapped ring of staging memory and are ordered with the dispatches around them
// by the GPU: nobody waits for them, unless the ring is full.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/memory/page_table.hpp"
#include "renderer/device/gl/memory/staging_ring.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/select/select.hpp"

namespace scancast::gl {

struct SampleCacheOptions {
    std::uint64_t memoryLimit = 0;  ///< bytes of samples and what stands beside them at most
    /// Bytes of the first page; each next one is twice as large, up to what the driver reads as texels, or
    /// the largest.
    std::uint64_t firstPage = 0;
    std::uint64_t largestPage = std::uint64_t(128) << 20;
};

class SampleCache {
  public:
    SampleCache(const GlFunctions& gl, const SampleCacheOptions& options);

    /// Samples that fit at once, without that.
    std::uint64_t capacity() const { return table_.capacity(); }
    /// Of the pages that there are.
    std::uint64_t bytes() const { return bytes_; }
    /// Since the beginning.
    std::uint64_t bytesUploaded() const { return bytesUploaded_; }
    /// Whether all samples of an octree's node are here, and if need be what stands beside them.
    bool has(std::uint64_t source, std::uint32_t node, std::uint32_t samples, bool beside) const;
    /// Uploads what is not here of these runs of one octree, as many as fit, and counts all as used: for
    /// pictures to come. Errors: Cancelled; ResourceLimit, DeviceLost: the driver's.
    Expected<void> bring(std::uint64_t source, std::span<const CutRun> runs, const std::stop_token& stop);

  private:
    friend class CutSamples;

    /// What a cut is dealt out to: as many samples of a run as one entry of the table holds.
    struct Part {
        SampleKey key;
        std::uint32_t run = 0;  ///< index in the cut
        std::span<const Sample> samples;
        std::span<const BesideWord> beside;  ///< of the samples, or empty
    };
    void addParts(const SampleKey& key, std::uint32_t run, const CutRun& from,
                  std::vector<Part>& parts) const;
    /// They are wanted, the first of them soonest.
    void touch(std::span<const Part> parts);
    /// The places of a part, uploaded if need be; empty: no room but in the batch that is being loaded.
    Expected<std::span<const Place>> load(const Part& part);
    Expected<void> upload(std::span<const Place> places, const Part& part);
    template <class T>
    Expected<void> copy(std::span<const T> values, std::uint32_t page, std::uint32_t texel);
    /// False: the GPU has no memory for them, and there are fewer pages from now on.
    Expected<bool> makePages(std::span<const Place> places);

    struct Page {
        Buffer buffer;
        Texels texels;
    };

    const GlFunctions& gl_;
    PageTable table_;
    std::uint32_t mostInPart_;
    std::vector<std::optional<Page>> pages_;  ///< as they are needed
    StagingRing staging_;
    std::uint64_t bytes_ = 0, bytesUploaded_ = 0;
};

/// Samples of a run that stand side by side in a page.
struct Extent {
    std::uint32_t run = 0;    ///< index in the cut's runs
    std::uint32_t first = 0;  ///< index in the run of the first
    std::uint32_t count = 0;
    std::uint32_t at = 0;  ///< the first's place in the page, texels
    std::uint32_t beside =
        0;  ///< its word beside it, counted in fours of bytes, the others' behind it; 0: not there
};

/// What is drawn without moving samples: one page bound after the other.
struct SampleBatch {
    struct Page {
        const Texels* texels = nullptr;
        std::span<const Extent> extents;  ///< in the order of the runs that were asked for
    };
    std::span<const Page> pages;
    /// The same number as before, by whomever: the same pages and extents, so that what was made of them is still true.
    /// Never 0.
    std::uint64_t version = 0;
};

/// The samples of one cut on the GPU, for as long as a layer draws them.
class CutSamples {
  public:
    /// Of the cut, only `runs` (indices), in the order in which they had best be drawn. A cut without a
    /// source is uploaded for this object only, and leaves room when it goes. Cache and cut outlive it.
    CutSamples(SampleCache& cache, const Cut& cut, std::span<const std::uint32_t> runs);
    ~CutSamples();
    CutSamples(const CutSamples&) = delete;
    CutSamples& operator=(const CutSamples&) = delete;

    /// All of them are here at once, in one batch.
    bool whole() const { return whole_; }
    /// They are wanted once more, by the next picture of the same runs: they count as used just now.
    void again();

    /// The first batch, loaded; what forEachBatch() will begin with, and true until it is called, or anybody
    /// else's loads. Errors: forEachBatch()'s.
    Expected<SampleBatch> gather(const std::stop_token& stop);
    /// Calls `draw` with every wanted sample in exactly one batch: one call where they all fit, which costs
    /// nothing from the second time on. What `draw` gets is true until it returns. Errors: Cancelled; those
    /// of `draw`; ResourceLimit, DeviceLost: the driver's.
    using Draw = std::function<Expected<void>(const SampleBatch&)>;
    Expected<void> forEachBatch(const Draw& draw, const std::stop_token& stop);

  private:
    Expected<std::size_t> loadBatch(std::size_t from, const std::stop_token& stop);

    SampleCache& cache_;
    std::vector<SampleCache::Part> parts_;
    std::vector<std::vector<Extent>> extents_;  ///< of the batch, by page
    std::vector<SampleBatch::Page> batchPages_;
    bool passing_ = false;       ///< parts that leave room when this goes
    std::size_t gathered_ = 0;   ///< parts in the batch that is loaded, from the first on
    bool whole_ = false;         ///< the batch holds everything, and
    std::uint64_t evicted_ = 0;  ///< nothing has gone since then
    std::uint64_t uses_ = 0;     ///< nothing else was used since then
    std::uint64_t version_ = 0;
};

}  // namespace scancast::gl
