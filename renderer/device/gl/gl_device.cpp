#include "renderer/device/gl/gl_device.hpp"

#include <chrono>
#include <new>

#include "renderer/device/gl/egl_context.hpp"
#include "renderer/device/gl/gl_passes.hpp"
#include "renderer/device/gl/osmesa_context.hpp"

namespace scancast {
namespace gl {
namespace {

/// Sums of frames are 16 bits a channel.
constexpr std::size_t maxFrames = 256;

/// Adds the time of its scope to a stage.
class StageTimer {
  public:
    StageTimer(FrameStats& stats, const char* stage) : stats_(stats), stage_(stage) {}
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;
    ~StageTimer() {
        const auto passed = std::chrono::steady_clock::now() - start_;
        stats_.add(stage_, std::chrono::duration<double, std::milli>(passed).count());
    }

  private:
    FrameStats& stats_;
    const char* stage_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Integer mean of frames: colour weighted by coverage, straight alpha; as the cpu device computes it.
class Average {
  public:
    explicit Average(std::size_t bytes) : sums_(bytes, 0) {}

    void add(std::span<const std::uint8_t> rgba) {
        for (std::size_t i = 0; i < sums_.size(); ++i)
            sums_[i] = static_cast<std::uint16_t>(sums_[i] + rgba[i]);
    }
    void write(std::span<std::uint8_t> rgba, int frames) const {
        for (std::size_t i = 0; i < sums_.size(); i += 4) {
            const int covered = std::max(1, sums_[i + 3] / 255);
            for (std::size_t c = 0; c < 3; ++c)
                rgba[i + c] = static_cast<std::uint8_t>((sums_[i + c] + covered / 2) / covered);
            rgba[i + 3] = static_cast<std::uint8_t>((sums_[i + 3] + frames / 2) / frames);
        }
    }

  private:
    std::vector<std::uint16_t> sums_;
};

class GlDevice final : public Device {
  public:
    static Expected<std::unique_ptr<Device>> create(Expected<std::unique_ptr<Context>> context,
                                                    const GlOptions& options) {
        if (!context) return tl::unexpected(context.error());
        auto current = Context::Current::enter(**context);
        if (!current) return tl::unexpected(current.error());
        auto driver = describeDriver((*context)->functions());
        if (!driver) return tl::unexpected(driver.error());
        logDriverMessages((*context)->functions());
        return std::unique_ptr<Device>(new GlDevice(std::move(*context), *driver, options));
    }

    ~GlDevice() override {
        // Its buffers and programs go while the context is current; if that fails they go with the context.
        const auto current = Context::Current::enter(*context_);
        passes_.reset();
    }

    DeviceInfo info() const override { return info_; }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        try {
            const auto current = Context::Current::enter(*context_);
            if (!current) return tl::unexpected(current.error());
            return drawCurrent(drawing, stop);
        } catch (const std::bad_alloc&) {
            return fail(ErrorCode::ResourceLimit,
                        "There is not enough memory to draw this picture; ask for a smaller one.");
        }
    }

  private:
    GlDevice(std::unique_ptr<Context> context, const DriverStrings& driver, const GlOptions& options)
        : context_(std::move(context)),
          passes_(std::make_unique<Passes>(context_->functions(), options.programFolder)) {
        info_ = {context_->backend(), driver.vendor, driver.renderer, driver.version, !driver.software, {}};
        info_.identity = info_.name + "; " + driver.renderer + "; " + driver.version;
    }

    Expected<Frame> drawCurrent(const Drawing& drawing, const std::stop_token& stop) {
        if (drawing.jitter.size() > maxFrames)
            return fail(ErrorCode::ResourceLimit,
                        "At most " + std::to_string(maxFrames) + " frames can be averaged into one picture.");
        if (!drawing.reflections.empty() || !drawing.filter.dropped.empty())
            return fail(ErrorCode::Unsupported,
                        "OpenGL draws no mirrors yet; draw with --backend=cpu, or with mirrors=false and "
                        "behindMirrors=true.");
        Frame frame;
        const auto plan = [&] {
            const StageTimer timer(frame.stats, "nearest");
            return planDrawing(drawing, passes_->limits());
        }();
        if (!plan) return tl::unexpected(plan.error());
        frame.width = drawing.window.width;
        frame.height = drawing.window.height;
        const std::size_t pixels =
            static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
        frame.rgba.resize(pixels * 4);
        frame.depth.resize(pixels);
        if (auto begun = passes_->begin(*plan); !begun) return tl::unexpected(begun.error());
        auto drawn = drawing.jitter.size() == 1 ? drawFrame(*plan, drawing.jitter[0], true, frame, stop)
                                                : drawAveraged(*plan, drawing.jitter, frame, stop);
        if (!drawn) return tl::unexpected(drawn.error());
        tellCut(*drawing.cut, frame.stats);
        return frame;
    }

    Expected<void> drawAveraged(const DrawPlan& plan, std::span<const glm::dvec2> jitter, Frame& frame,
                                const std::stop_token& stop) {
        Average average(frame.rgba.size());
        for (std::size_t i = 0; i < jitter.size(); ++i) {
            if (auto drawn = drawFrame(plan, jitter[i], i == 0, frame, stop); !drawn) return drawn;
            const StageTimer timer(frame.stats, "average");
            average.add(frame.rgba);
        }
        const StageTimer timer(frame.stats, "average");
        average.write(frame.rgba, static_cast<int>(jitter.size()));
        return {};
    }

    /// One anti-aliasing frame, read back into the picture; depth too where it is the first.
    Expected<void> drawFrame(const DrawPlan& plan, const glm::dvec2& jitter, bool first, Frame& frame,
                             const std::stop_token& stop) {
        const auto timed = [&](const char* stage, const auto& work) {
            const StageTimer timer(frame.stats, stage);
            return work();
        };
        Expected<void> done = timed("nearest", [&] { return passes_->nearest(jitter, stop); });
        if (done) done = timed("resolve", [&] { return passes_->resolve(); });
        if (done && plan.eyeDome) done = timed("eyedome", [&] { return passes_->eyeDome(); });
        if (done) done = timed("read-back", [&] { return passes_->readColor(frame.rgba); });
        if (done && first) done = timed("read-back", [&] { return passes_->readDepth(frame.depth); });
        return done;
    }

    void tellCut(const Cut& cut, FrameStats& stats) const {
        stats.samplesDrawn = cut.samples;
        stats.pointsShown = cut.points;
        stats.nodesVisited = cut.nodesVisited;
        stats.nodesCulled = cut.nodesCulled;
        stats.spacingReached = cut.spacingReached;
        stats.device = info_.name;
    }

    std::unique_ptr<Context> context_;
    std::unique_ptr<Passes> passes_;
    DeviceInfo info_;
};

/// What opens is described by its driver; what does not, by why.
DeviceInfo describe(const char* backend, int eglDevice, const Expected<std::unique_ptr<Device>>& device) {
    DeviceInfo info;
    if (device) {
        info = (*device)->info();
    } else {
        info.name = backend;
        info.version = device.error().message;
    }
    info.eglDevice = eglDevice;
    return info;
}

}  // namespace
}  // namespace gl

Expected<std::unique_ptr<Device>> createEglDevice(int device, const GlOptions& options) {
    return gl::GlDevice::create(gl::createEglContext(device), options);
}

Expected<std::unique_ptr<Device>> createOsmesaDevice(const GlOptions& options) {
    return gl::GlDevice::create(gl::createOsmesaContext(), options);
}

Expected<std::unique_ptr<Device>> createHardwareEglDevice(const GlOptions& options) {
    const auto devices = gl::listEglDevices();
    if (!devices) return tl::unexpected(devices.error());
    std::string reasons;
    for (const gl::EglDevice& device : *devices) {
        if (device.software) continue;
        auto opened = createEglDevice(device.index, options);
        // A device without a driver of its own may fall back to a rasteriser.
        if (opened && (*opened)->info().hardware) return opened;
        reasons +=
            " Device " + std::to_string(device.index) + ": " +
            (opened ? "it turned out to be " + (*opened)->info().renderer + "." : opened.error().message);
    }
    return fail(ErrorCode::DeviceUnavailable, "EGL finds no GPU here." + reasons);
}

std::vector<DeviceInfo> listGlDevices() {
    std::vector<DeviceInfo> infos;
    const auto devices = gl::listEglDevices();
    if (devices) {
        for (const gl::EglDevice& device : *devices)
            infos.push_back(gl::describe("egl", device.index, createEglDevice(device.index)));
    } else {
        infos.push_back(gl::describe("egl", -1, createEglDevice(-1)));
    }
    infos.push_back(gl::describe("osmesa", -1, createOsmesaDevice()));
    return infos;
}

}  // namespace scancast
