// A device for tests of the server: paints a plain colour, remembers what it was asked for, and waits at a
// gate when the test wants it to. Shared by unit and integration tests. *Thread safety*: every function may
// be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "server/scheduler/picture.hpp"

namespace scancast::test {

class FakePainter {
  public:
    static constexpr std::chrono::seconds patience{
        20};  // far beyond what any test needs; a hang fails, not blocks

    struct Painted {
        const Cloud* cloud;
        View view;
    };

    /// For the scheduler; this object must outlive it.
    OpenPainter open() {
        return [this]() -> Expected<Painter> {
            DeviceInfo info;
            info.name = info.identity = "fake";
            Painter painter;
            painter.device = info;
            painter.prepare = [this](const PictureOrder& order, bool wait, std::stop_token stop) {
                return prepare(order, wait, stop);
            };
            painter.paint = [this](const PictureOrder& order, const PreparedPicture&, std::stop_token stop) {
                return paint(*order.cloud, order.view, stop);
            };
            return painter;
        };
    }

    /// From now on every picture waits until let() or its stop.
    void closeGate() {
        const std::lock_guard lock(mutex_);
        gated_ = true;
        tickets_ = 0;
    }
    /// Lets `count` pictures through.
    void let(int count) {
        const std::lock_guard lock(mutex_);
        tickets_ += count;
        changed_.notify_all();
    }
    void openGate() {
        const std::lock_guard lock(mutex_);
        gated_ = false;
        changed_.notify_all();
    }

    /// From now on blocks are missing: complete pictures wait for them until loaded() or their stop.
    void unload() {
        const std::lock_guard lock(mutex_);
        loaded_ = false;
    }
    void load() {
        const std::lock_guard lock(mutex_);
        loaded_ = true;
        changed_.notify_all();
    }
    /// Waits until `count` pictures wait for blocks; false = it took too long.
    bool waitLoading(int count) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, patience, [&] { return loading_ >= count; });
    }

    /// Waits until `count` pictures have been begun since the start; false = it took too long.
    bool waitBegun(std::size_t count) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, patience, [&] { return begun_.size() >= count; });
    }
    std::vector<Painted> begun() const {
        const std::lock_guard lock(mutex_);
        return begun_;
    }
    int cancelled() const {
        const std::lock_guard lock(mutex_);
        return cancelled_;
    }
    /// What the next pictures fail with.
    void failWith(std::optional<Error> error) {
        const std::lock_guard lock(mutex_);
        error_ = std::move(error);
    }

  private:
    Expected<PreparedPicture> prepare(const PictureOrder&, bool wait, const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        if (!wait || loaded_) return PreparedPicture{nullptr, loaded_};
        ++loading_;
        changed_.notify_all();
        const auto end = std::chrono::steady_clock::now() + patience;
        while (!loaded_ && !stop.stop_requested() && std::chrono::steady_clock::now() < end) {
            changed_.wait_for(lock, std::chrono::milliseconds(1));
        }
        --loading_;
        if (stop.stop_requested()) {
            ++cancelled_;
            return fail(ErrorCode::Cancelled, "stopped");
        }
        return PreparedPicture{};
    }

    Expected<Frame> paint(const Cloud& cloud, const View& view, const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        begun_.push_back({&cloud, view});
        changed_.notify_all();
        const auto end = std::chrono::steady_clock::now() + patience;
        while (gated_ && tickets_ == 0 && !stop.stop_requested() && std::chrono::steady_clock::now() < end) {
            changed_.wait_for(lock, std::chrono::milliseconds(1));
        }
        if (stop.stop_requested()) {
            ++cancelled_;
            return fail(ErrorCode::Cancelled, "stopped");
        }
        if (gated_) --tickets_;
        if (error_) return tl::unexpected(*error_);
        return frameOf(cloud, view);
    }

    // A colour that depends on cloud, camera and samples: pictures that get mixed up differ in their bytes.
    static Frame frameOf(const Cloud& cloud, const View& view) {
        Frame frame;
        frame.width = view.width;
        frame.height = view.height;
        const auto pixels = std::size_t(view.width) * std::size_t(view.height);
        frame.rgba.resize(pixels * 4, 255);
        frame.depth.resize(pixels, 1.0F);
        for (std::size_t i = 0; i < pixels; ++i) {
            frame.rgba[4 * i] = std::uint8_t(view.camera.eye.x);
            frame.rgba[4 * i + 1] = std::uint8_t(cloud.points);
            frame.rgba[4 * i + 2] = std::uint8_t(40 * view.quality.samples.value_or(defaultSamples));
        }
        frame.stats.add("select", 0.1);
        frame.stats.samplesDrawn = 7;
        return frame;
    }

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Painted> begun_;
    std::optional<Error> error_;
    bool gated_ = false;
    bool loaded_ = true;
    int loading_ = 0;
    int tickets_ = 0;
    int cancelled_ = 0;
};

/// A cloud of one point, coloured and with every attribute; `points` tells clouds apart.
inline std::shared_ptr<const Cloud> tinyCloud(std::uint64_t points = 1) {
    auto cloud = std::make_shared<Cloud>();
    cloud->title = "tiny";
    cloud->format = "made by hand";
    cloud->bounds = {glm::dvec3(0, 0, 0), glm::dvec3(10, 10, 5)};
    cloud->points = points;
    cloud->attributes = {true, true, true, true};
    cloud->classCounts[2] = points;
    cloud->spacing = 0.1;
    cloud->revision = "revision-" + std::to_string(points);
    Node root{};
    root.step = glm::dvec3(1);
    root.boxMax = glm::dvec3(10, 10, 5);
    root.radius = 10;
    root.spacing = 0.1F;
    root.sampleCount = 1;
    root.points = points;
    cloud->octree = Octree({root}, {Sample{}});
    return cloud;
}

}  // namespace scancast::test
