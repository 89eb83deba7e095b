// A device for tests of the server: paints a plain colour, remembers what it was asked for, and waits at a
// gate when the test wants it to. Shared by unit and integration tests. *Thread safety*: every function may
// be called from any thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/scheduler/picture_order.hpp"

namespace scancast::test {

class FakePainter {
  public:
    static constexpr std::chrono::seconds patience{
        20};  // far beyond what any test needs; a hang fails, not blocks

    struct Painted {
        const Cloud* cloud;
        View view;
    };

    explicit FakePainter(std::string name = "fake") : name_(std::move(name)) {}

    /// For the scheduler; this object must outlive it.
    OpenPainter open(OpenPainter instead = {}) {
        return [this, instead]() -> Expected<Painter> {
            DeviceInfo info;
            info.name = info.identity = name_;
            Painter painter;
            painter.device = info;
            painter.instead = instead;
            painter.prepare = [this](const PictureOrder& order, bool wait, std::stop_token stop) {
                return prepare(order, wait, stop);
            };
            painter.begin = [this](const PictureOrder& order, const PreparedPicture&, std::stop_token stop,
                                   const Pause&) {
                keep(order.cloud);
                return begin(*order.cloud, order.view, std::move(stop));
            };
            return painter;
        };
    }

    /// From now on the clouds of what is painted live as long as this, so that tests may look at them afterwards.
    void keepClouds() {
        const std::lock_guard lock(mutex_);
        keeps_ = true;
    }
    /// From now on pictures are begun at once, and it is their pixels that come late: they wait at the gate.
    void finishLate() {
        const std::lock_guard lock(mutex_);
        late_ = true;
    }
    /// Pictures begun and neither finished nor dropped, at most at the same time.
    int mostAtOnce() const {
        const std::lock_guard lock(mutex_);
        return mostAtOnce_;
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

    /// So many blocks cannot be read of what the next pictures show.
    void damage(std::uint32_t blocks) {
        const std::lock_guard lock(mutex_);
        damaged_ = blocks;
    }
    /// Whether the next pictures say that a part of the server is.
    void setAway(bool away) {
        const std::lock_guard lock(mutex_);
        away_ = away;
    }

  private:
    void keep(const std::shared_ptr<const Cloud>& cloud) {
        const std::lock_guard lock(mutex_);
        if (keeps_) kept_.push_back(cloud);
    }
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

    class LateFrame final : public PendingFrame {
      public:
        LateFrame(FakePainter& painter, Frame frame, std::stop_token stop)
            : painter_(painter), frame_(std::move(frame)), stop_(std::move(stop)) {}
        ~LateFrame() override {
            const std::lock_guard lock(painter_.mutex_);
            --painter_.atOnce_;
        }
        bool ready() override {
            const std::lock_guard lock(painter_.mutex_);
            return !painter_.gated_ || painter_.tickets_ > 0;
        }
        Expected<Frame> finish() override {
            std::unique_lock lock(painter_.mutex_);
            if (auto ok = painter_.passGate(lock, stop_); !ok) return passOn(ok);
            return std::move(frame_);
        }

      private:
        FakePainter& painter_;
        Frame frame_;
        std::stop_token stop_;
    };

    Expected<std::unique_ptr<PendingFrame>> begin(const Cloud& cloud, const View& view,
                                                  std::stop_token stop) {
        std::unique_lock lock(mutex_);
        begun_.push_back({&cloud, view});
        changed_.notify_all();
        if (late_) {
            auto frame = std::make_unique<LateFrame>(*this, frameOf(cloud, view), std::move(stop));
            mostAtOnce_ = std::max(mostAtOnce_, ++atOnce_);
            return frame;
        }
        if (auto ok = passGate(lock, stop); !ok) return passOn(ok);
        return std::make_unique<DrawnFrame>(frameOf(cloud, view));
    }

    Expected<void> passGate(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
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
        return {};
    }

    // A colour that depends on cloud, camera and samples: pictures that get mixed up differ in their bytes.
    Frame frameOf(const Cloud& cloud, const View& view) const {
        Frame frame;
        frame.width = view.width;
        frame.height = view.height;
        const auto pixels = std::size_t(view.width) * std::size_t(view.height);
        std::vector<std::uint8_t>& rgba = frame.rgba.own();
        rgba.resize(pixels * 4, 255);
        frame.depth.own().resize(pixels, 1.0F);
        for (std::size_t i = 0; i < pixels; ++i) {
            rgba[4 * i] = std::uint8_t(view.camera.eye.x);
            rgba[4 * i + 1] = std::uint8_t(cloud.points);
            rgba[4 * i + 2] = std::uint8_t(40 * view.quality.samples.value_or(defaultSamples));
        }
        frame.stats.add("select", 0.1);
        frame.stats.samplesDrawn = 7;
        frame.stats.nodesDamaged = damaged_;
        frame.stats.away = away_;
        return frame;
    }

    const std::string name_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Painted> begun_;
    std::optional<Error> error_;
    bool gated_ = false;
    bool keeps_ = false;
    std::vector<std::shared_ptr<const Cloud>> kept_;
    bool late_ = false;
    int atOnce_ = 0, mostAtOnce_ = 0;
    bool loaded_ = true;
    std::uint32_t damaged_ = 0;
    bool away_ = false;
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

/// A store of which everything is always still to come; what pictures lack is what the test says.
class NeverWhole final : public SampleStore {
  public:
    std::optional<SampleRun> find(std::uint32_t) override { return std::nullopt; }
    Expected<SampleRun> load(std::uint32_t, std::stop_token) override { return fail(ErrorCode::Io, "never"); }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t>, std::stop_token) override {
        return {};
    }
    void request(std::uint64_t, std::vector<BlockRequest>) override {}
    bool whole() const override { return false; }
    bool damaged(std::uint32_t) const override { return false; }
    std::uint64_t capacity() const override { return 1000; }
    std::uint64_t bytesResident() const override { return 0; }
};

/// tinyCloud() in such a store.
inline std::shared_ptr<const Cloud> coldCloud() {
    auto cloud = std::make_shared<Cloud>(*tinyCloud());
    const auto nodes = cloud->octree.nodes();
    cloud->octree = Octree(std::vector<Node>(nodes.begin(), nodes.end()), std::make_shared<NeverWhole>());
    return cloud;
}

/// Whether that comes true in time: a hang fails, not blocks.
template <class Condition>
bool soon(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + FakePainter::patience;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::yield();
    }
    return true;
}

}  // namespace scancast::test
