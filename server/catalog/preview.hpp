// A coarse cloud of a scan that is still being read: a source that keeps every n-th point that passes through
// it, and builds small clouds of them meanwhile. Pipeline: import → **preview** → octree builder; beside it:
// → catalog.
//
// Owned and used by the thread that reads; small clouds are built, and handed over, on a thread of its own.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

/// Points evenly spread over all that were added: every n-th, n doubled whenever there would be too many.
class StrideSample {
  public:
    explicit StrideSample(std::size_t most) : most_(most) {}
    void add(const PointBatch& batch);
    const PointBatch& points() const { return points_; }
    std::uint64_t stride() const { return stride_; }

  private:
    const std::size_t most_;
    PointBatch points_;
    std::uint64_t stride_ = 1, seen_ = 0;
    std::uint64_t next_ = 0;  // number of the next point to keep
};

struct PreviewOptions {
    std::string title;
    std::size_t mostPoints = 1'000'000, mostOfFirst = 50'000;
    /// Something to look at, at once: a small preview is made of what the source gives to glance at, or else after this
    /// long.
    std::chrono::milliseconds first{100};
    /// Then one after this long, and whenever as much time has passed again as before the last one; and when everything
    /// is read, if that took so long.
    std::chrono::milliseconds second{1000};
    int threads = 0;
    std::function<void(std::shared_ptr<const Cloud>)> show;  ///< called on the preview's thread
};

class PreviewSource final : public ForwardingSource {
  public:
    PreviewSource(std::unique_ptr<PointSource> source, PreviewOptions options);
    /// Waits for the preview that is being built.
    ~PreviewSource() override;

    Expected<bool> read(PointBatch& batch) override;

  private:
    using Clock = std::chrono::steady_clock;
    void showGlance();
    void build(PointBatch points);
    void show(const ScanHeader& header, PointBatch points) const;

    const PreviewOptions options_;
    PointBatch glance_;
    StrideSample sample_;
    std::optional<Clock::time_point> began_;
    Clock::duration next_;
    bool isFirst_ = true;
    std::atomic<bool> building_{false};
    std::thread builder_;
};

}  // namespace scancast
