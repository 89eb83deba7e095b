// What the GPU is told of a layer: tables in buffers that live as long as the device, since making buffers takes a
// driver longer than filling them. They are filled through a mapped ring (staging_ring.hpp), in order with the
// dispatches around it: the picture before may still be read from them. What the GPU knows from the picture before
// it is not told again (docs/decisions/043-told-once.md). Owned by a GL device; inside a Current scope of its context.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "renderer/device/gl/memory/sample_cache.hpp"
#include "renderer/device/gl/memory/splat_params.hpp"
#include "renderer/device/gl/memory/staging_ring.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {

class ScreenShaders;

/// Bytes of a buffer for as many, with room for more, so that it grows seldom.
inline std::size_t roomFor(std::size_t bytes) {
    constexpr std::size_t smallest = 4096;
    return std::bit_ceil(std::max(bytes, smallest));
}

/// From its beginning. ResourceLimit, DeviceLost.
template <class T>
Expected<void> fillBuffer(Buffer& buffer, const std::vector<T>& values, StagingRing& ring) {
    const auto bytes = std::as_bytes(std::span(values));
    if (auto ok = buffer.reserve(roomFor(bytes.size())); !ok) return ok;
    return ring.copy(bytes, buffer, 0);
}

/// What the host makes for every picture, and the GPU is told where it is another than before. T: plain, without holes.
template <class T>
class ToldTable {
  public:
    ToldTable(const GlFunctions& gl, const char* what) : buffer_(gl, what, Buffer::Use::Copies) {}

    /// Tells what stands in `values`, which may hold anything afterwards: values() has it. ResourceLimit, DeviceLost.
    Expected<void> tell(std::vector<T>& values, StagingRing& ring) {
        if (version_ != 0 && same(values)) return {};
        version_ = 0;
        std::swap(told_, values);
        if (auto ok = fillBuffer(buffer_, told_, ring); !ok) return ok;
        version_ = newSource();
        return {};
    }
    const std::vector<T>& values() const { return told_; }
    /// The same number as before: nothing was told since. Never 0.
    std::uint64_t version() const { return version_; }
    const Buffer& buffer() const { return buffer_; }

  private:
    bool same(const std::vector<T>& values) const {
        if (values.size() != told_.size()) return false;
        return values.empty() || std::memcmp(values.data(), told_.data(), values.size() * sizeof(T)) == 0;
    }

    Buffer buffer_;
    std::vector<T> told_;
    std::uint64_t version_ = 0;
};

/// A run that is drawn, and the samples that it is drawn with.
struct DrawnRun {
    std::uint32_t run = 0;  ///< index in the cut
    std::uint32_t node = noNode;
    const Sample* samples = nullptr;
    std::size_t count = 0;
    const BesideWord* beside = nullptr;
    bool operator==(const DrawnRun&) const = default;
};

/// A cut's samples as the picture before left them, for the next one of the same runs.
struct KeptSamples {
    std::unique_ptr<CutSamples> samples;
    std::uint64_t source = 0;
    std::vector<DrawnRun> runs;
    glm::dvec3 direction{0};  ///< of sight, by which they are ordered from front to back
};

/// What a batch's pages are drawn by.
struct BatchTables {
    /// Of a page, in the chunks and extents that the GPU has.
    struct PageWork {
        std::uint32_t firstChunk = 0, chunks = 0;
        std::uint32_t firstExtent = 0, extents = 0;
    };
    /// What they were made of: the same, and they are still true.
    struct MadeOf {
        std::uint64_t batch = 0, runs = 0;  ///< versions
        std::uint32_t chunkSamples = 0;
        bool extents = false;
        bool operator==(const MadeOf&) const = default;
    };
    struct Needs {
        std::span<const std::uint32_t> runOfCut;  ///< from the cut's runs to the tables'
        std::uint32_t chunkSamples = 0;           ///< of a chunk at most
        bool extents = false;                     ///< ordinals are looked up
    };
    std::vector<PageWork> pages;
    MadeOf madeOf;
};

/// One layer's tables (splat_layouts.hpp). The ring outlives them, and so does the sample cache.
struct LayerMemory {
    LayerMemory(const GlFunctions& gl, StagingRing& filledThrough)
        : ring(filledThrough),
          facts(gl, "facts of runs"),
          lookUps(gl, "tables"),
          rows(gl, "background"),
          runs(gl, "runs", Buffer::Use::Copies),
          chunks(gl, "chunks", Buffer::Use::Copies),
          extents(gl, "extents", Buffer::Use::Copies) {}

    /// The pages and extents that are drawn next, unless it was that already. ResourceLimit, DeviceLost.
    Expected<void> tell(const SampleBatch& told, const BatchTables::Needs& needs);
    /// `facts` as they are seen from somewhere → `runs` (composed_runs.hpp). ResourceLimit, DeviceLost.
    Expected<void> compose(ScreenShaders& shaders, const ComposeParams& params, bool onGpu);

    StagingRing& ring;
    ToldTable<RunFacts> facts;
    ToldTable<std::uint32_t> lookUps, rows;
    Buffer runs, chunks, extents;
    KeptSamples kept;
    BatchTables batch;
    // The host's side of them, whose memory is used again, too.
    SplatTables host;
    std::vector<SplatChunk> chunkList;
    std::vector<SplatExtent> extentList;
    std::vector<RunParams> runList;  ///< where the host composes
};

}  // namespace scancast::gl
