// Draws one picture's frames on the CPU: the work between a checked Drawing and its Frame. Made for one
// draw() and thrown away with it, on the render thread; the tasks that it starts run in the device's arena.
#pragma once

#include <tbb/task_arena.h>
#include <atomic>
#include <memory>
#include <stop_token>
#include <vector>

#include "renderer/device/cpu/prepare.hpp"
#include "renderer/device/cpu/tiles.hpp"

namespace scancast::cpu {

/// Buffers that live as long as the device, so that pictures do not wait for fresh memory.
struct Buffers {
    std::vector<std::unique_ptr<std::vector<Key>>> keys;  ///< one block per thread
    std::vector<std::uint32_t> rgba;  ///< before eye-dome lighting, and frames to be averaged
    std::vector<std::uint32_t> shaded;
    std::vector<float> depth, logDepth;
    std::vector<std::uint16_t> sums;
    ColorTables tables;
};

/// The passes of a drawing as this device runs them.
struct PassPlan {
    NearestPass nearest;
    std::optional<EyeDomePass> eyeDome;
};

/// Unsupported for a list that is not nearest, resolve and at most one eye-dome pass.
Expected<PassPlan> planPasses(std::span<const Pass> passes);

class Picture {
  public:
    Picture(const Drawing& drawing, const PassPlan& plan, const Kernels& kernels, int threads,
            tbb::task_arena& arena, Buffers& buffers, std::stop_token stop);
    Expected<Frame> draw();

  private:
    /// Pixels in memory: `area` of the whole picture, row by row.
    struct Surface {
        Rect area;
        std::uint32_t* rgba = nullptr;
        float* depth = nullptr;  ///< may be null
    };

    void prepareRuns();
    void drawFrame(const glm::dvec2& jitter, bool first, std::uint32_t* out, Frame& frame);
    void drawAveraged(Frame& frame);
    void drawTile(const Tile& tile, const SplatPass& pass, const Surface& surface);
    void drawRuns(const Tile& tile, const SplatPass& pass, const KeyTile& keys);
    void light(const Surface& from, std::uint32_t* out);
    void copyDepth(const Surface& from, Frame& frame);
    void accumulate(const std::uint32_t* rgba);
    KeyTile keyTile(const Rect& area);
    /// Runs work(0) … work(count - 1), in any order; stops early when asked to.
    template <class Work>
    void inParallel(int count, const Work& work);
    /// The same over bands of rows.
    template <class Work>
    void overRows(int rows, const Work& work);

    const Drawing& drawing_;
    const PassPlan& plan_;
    const Kernels& kernels_;
    const int threads_;
    tbb::task_arena& arena_;
    Buffers& buffers_;
    const std::stop_token stop_;
    Rect window_;
    Rect area_;  ///< the window, and what eye-dome lighting looks at beyond it
    SplatPass pass_;
    std::vector<PreparedRun> runs_;
    std::vector<Tile> tiles_;
    std::vector<std::uint32_t> background_;                      ///< rows of area_
    std::atomic<std::int64_t> nearestTime_{0}, resolveTime_{0};  ///< ns, all threads
};

}  // namespace scancast::cpu
