// One cut seen from one viewpoint: its runs made ready once, then drawn once per jittered frame - of sprites, several frames
// at once - tile by tile through all splat passes, into planes of pixels. A picture is a layer; every mirror that it shows is
// another. Made for one draw(), on the render thread. Where others draw the same picture's other samples, it is
// drawn pass by pass instead, with what they agree on in between (layer_together.cpp).
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "renderer/device/cpu/packed_spans.hpp"
#include "renderer/device/cpu/prepare.hpp"
#include "renderer/device/cpu/tiles.hpp"
#include "renderer/device/cpu/workers.hpp"
#include "renderer/device/host/colors.hpp"

namespace scancast::cpu {

/// What a tile is drawn in. Grows to the largest tile and stays.
struct TileMemory {
    std::vector<Key> keys;  ///< a block per kind of key
    std::vector<std::int32_t> sums;
    std::vector<std::int64_t> wide;
};

/// As many as there are threads.
using TileMemories = std::vector<std::unique_ptr<TileMemory>>;

/// Whom a picture is drawn together with, and memory for it. Lives as long as the device.
struct Together {
    PassReduction* reduction = nullptr;
    /// Of the picture: each device's rows are seen with so many around them.
    std::int32_t reach = 0;
    TileMemories tiles;  ///< a tile each: all of them are needed until the last pass
    PackedSpans packed;
    OccupiedSpans all;         ///< everybody's
    std::vector<float> depth;  ///< of the layer
};

/// What a layer needs to smooth the borders of paraboloids, besides what it draws into. Grows to the largest layer and stays.
struct OwnerMemory {
    std::vector<std::uint32_t> places, colors;
    std::vector<float> halves, orders;
    /// Planes of an area, with a border of background around it; at its first pixel.
    Owners around(const Rect& area);
};

/// Pixels in memory: `area` of the whole picture, row by row.
struct Planes {
    Rect area;
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;            ///< may be null
    std::uint32_t* normals = nullptr;  ///< may be null
    OwnerMemory* owners = nullptr;     ///< null: no borders are smoothed
    std::ptrdiff_t at(int x, int y) const {
        return static_cast<std::ptrdiff_t>(y - area.y0) * area.width() + (x - area.x0);
    }
};

/// Who gets what devices that draw together have.
enum class Receivers : std::uint8_t { Everybody, WhoShows };

class Layer {
  public:
    /// Everything outlives the layer. `together`: null, it is drawn alone.
    Layer(const Drawing& drawing, const CutView& view, const LayerView& layerView, const FramePasses& passes,
          const Kernels& kernels, const Workers& workers, TileMemories& memories, const Rect& area,
          Together* together = nullptr);
    /// How many frames whose planes have so many pixels draw() takes at once, at least 1. More of them at a time share the work of
    /// reading, filtering, colouring and projecting samples, and take more memory.
    int framesAtOnce(std::int64_t pixels) const;
    /// Splats and resolves a frame for each jitter; `planes` cover the layer's area. Together with others only own() of them are
    /// filled. Adds to the stages "nearest", "sum", "cell", "resolve" and "smooth", and together "wait" - until all have
    /// done a pass - and "reduce".
    void draw(std::span<const glm::dvec2> jitters, std::span<const Planes> planes, FrameStats& stats);
    void draw(const glm::dvec2& jitter, const Planes& planes, FrameStats& stats) {
        draw({&jitter, 1}, {&planes, 1}, stats);
    }
    /// Together with others, once drawn: rows of the area that this device finishes; and the part of such planes that it sees.
    Rows ownRows() const { return bands_.of(together_->reduction->number()); }
    Planes own(const Planes& planes) const;
    /// Everybody's rows of planes of the layer's width, or of a part of it, to who shows or to everybody: those planes that
    /// there are.
    void collect(const Planes& planes, Receivers to);

  private:
    void prepareRuns(const Drawing& drawing, const CutView& view);
    void listSamples(const Cut& cut);
    /// A tile that is being drawn, and how far it has come: one takes as long as its samples do, and the picture pauses
    /// meanwhile.
    struct TileDrawing {
        TileMemory* memory = nullptr;
        const Tile* tile = nullptr;  ///< null: it is done, or there is none
        KeyTile empty, nearest, colors;
        const Key* silhouette = nullptr;
        std::size_t pass =
            0;  ///< the next one, up to which it has come: `run` of the tile's, `sample` of the run's
        std::size_t run = 0;
        std::uint32_t sample = 0;
        KeyTile target;  ///< of the pass, once it has begun
        bool begun = false;
        /// Several frames at once: the target of each.
        std::array<FrameTile, mostFrames> frames;
        int frameCount = 1;
    };
    /// What is the same for all tiles of a frame.
    struct FrameDrawing {
        std::vector<SplatPass> passes;
        Planes planes;
        Owners owners;
    };

    void drawAlone(std::span<const FrameDrawing> frames, FrameStats& stats);
    void drawTogether(const FrameDrawing& frame, FrameStats& stats);
    Rows rows() const { return {0, area_.height()}; }
    /// The rows that a device finishes; those that it sees.
    Rows rowsOf(std::uint32_t device) const { return bands_.of(device); }
    Rows seenBy(std::uint32_t device) const { return bands_.of(device, together_->reach); }
    template <class Work>
    void inPieces(const std::vector<TileDrawing>& drawings, const Rows& rows, const Work& work) const;
    template <class Work>
    void inSpans(const std::vector<TileDrawing>& drawings, const OccupiedSpans& spans, const Rows& rows,
                 const Work& work) const;
    template <class T, class Pack, class Take>
    void toOwners(const std::vector<TileDrawing>& drawings, std::size_t planes, const Pack& pack,
                  const Take& take);
    void markPass(const TileDrawing& at, const SplatPass& pass, std::atomic<std::uint64_t>& magnitudes);
    bool agree(std::uint64_t& magnitudes);
    void reducePass(std::vector<TileDrawing>& drawings, const SplatPass& pass, bool last,
                    std::uint64_t magnitudes);
    void leastToOwners(const std::vector<TileDrawing>& drawings);
    void leastToEverybody(const std::vector<TileDrawing>& drawings);
    void addToOwners(std::vector<TileDrawing>& drawings, const SplatPass& pass, std::uint64_t magnitudes);
    void resolveTogether(std::vector<TileDrawing>& drawings, const FrameDrawing& frame);
    void joinSamples(const std::vector<TileDrawing>& drawings, const Planes& planes, const Owners& owners);
    void begin(TileDrawing& at, const Tile& tile, std::span<const FrameDrawing> frames = {});
    bool goOn(TileDrawing& at, std::span<const FrameDrawing> frames);
    void beginPass(TileDrawing& at, const SplatPass& pass);
    bool hidesRun(const TileDrawing& at, const Rect& part, std::int32_t frontOrder) const;
    bool drawRuns(TileDrawing& at, const SplatPass& pass);
    bool splatRun(TileDrawing& at, const PreparedRun& prepared, SplatRun slice, const SplatPass& pass);
    void resolveTile(const KeyTile& nearest, const KeyTile& colors, const SplatPass& pass,
                     const std::int64_t* wide, const Planes& planes, const Owners& owners);
    void smooth(const SplatPass& pass, const Planes& planes, const Owners& owners) const;

    const LayerView layerView_;
    const FramePasses& passes_;
    const Kernels& kernels_;
    const Workers& workers_;
    TileMemories& memories_;
    const Rect area_;
    Together* const together_;
    const ColorTables tables_;
    std::vector<SplatPass> splats_;
    std::vector<PreparedRun> runs_;  ///< front to back
    std::vector<Tile> tiles_;
    Bands bands_;                            ///< of all frames, once there is one that was drawn together
    std::vector<std::uint32_t> background_;  ///< rows of area_
    std::vector<SplatRun> byOrdinal_;        ///< with `samples`
    std::vector<std::uint32_t> runAt_;
    SampleTable samples_;
    std::array<std::atomic<std::int64_t>, mostSplatPasses + 1>
        spent_{};  ///< ns of all threads: by pass, and resolve
};

}  // namespace scancast::cpu
