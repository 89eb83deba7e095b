#include "renderer/device/gl/gl_device.hpp"

#include <fmt/format.h>

#include <new>
#include <utility>

#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"
#include "renderer/device/gl/memory/composed_runs.hpp"
#include "renderer/device/gl/memory/gl_memory.hpp"
#include "renderer/device/gl/memory/memory_limit.hpp"
#include "renderer/device/gl/passes/picture.hpp"

namespace scancast {
namespace gl {
namespace {

/// A picture whose pixels are on their way.
class GlPicture final : public PendingFrame {
  public:
    GlPicture(Context& context, std::unique_ptr<ReadBack::Transfer> pixels, StageTimes times, Frame frame,
              std::stop_token stop)
        : context_(context),
          pixels_(std::move(pixels)),
          times_(std::move(times)),
          frame_(std::move(frame)),
          stop_(std::move(stop)) {}

    bool ready() override {
        const auto current = Context::Current::enter(context_);
        return !current || pixels_->ready();
    }

    Expected<Frame> finish() override {
        const auto current = Context::Current::enter(context_);
        if (!current) return passOn(current);
        if (auto ok = pixels_->wait(stop_); !ok) return passOn(ok);
        frame_.rgba = pixels_->rgba();
        frame_.depth = pixels_->depth();
        if (auto ok = times_.collect(frame_.stats); !ok) return passOn(ok);
        return std::move(frame_);
    }

  private:
    Context& context_;
    std::unique_ptr<ReadBack::Transfer> pixels_;
    StageTimes times_;
    Frame frame_;
    std::stop_token stop_;
};

class GlDevice final : public Device {
  public:
    static Expected<std::unique_ptr<Device>> create(Expected<std::unique_ptr<Context>> opened,
                                                    const GlOptions& options) {
        if (!opened) return passOn(opened);
        std::shared_ptr<Context> context = std::move(*opened);
        auto current = Context::Current::enter(*context);
        if (!current) return passOn(current);
        auto driver = describeDriver(context->functions());
        if (!driver) return passOn(driver);
        const GlFunctions& gl = context->functions();
        logDriverMessages(gl);
        const auto arithmetic = options.arithmetic ? Expected<Arithmetic>(*options.arithmetic)
                                                   : findArithmetic(gl, options.programFolder);
        if (!arithmetic) return passOn(arithmetic);
        const auto samples = sampleCacheOptions(gl, driver->software, options.gpuMemoryLimit);
        const Findings found{*driver, *arithmetic, samples,
                             memoryBeside(gl, driver->software, samples.memoryLimit)};
        std::unique_ptr<GlDevice> device(new GlDevice(context, found, options));
        const auto exactDoubles = composesExactly(device->pool_->shaders);
        if (!exactDoubles) {
            current = passOn(exactDoubles);  // the device goes first, and is current for itself then
            return passOn(exactDoubles);
        }
        device->pool_->exactDoubles = *exactDoubles;
        return device;
    }

    ~GlDevice() override {
        // Its buffers and programs go while the context is current; if that fails they go with the context.
        const auto current = Context::Current::enter(*context_);
        pool_.reset();
    }

    DeviceInfo info() const override { return info_; }
    DeviceMemory* memory() override { return &memory_; }
    std::int64_t pixelsAtOnce() const override { return pixelsAtOnce_; }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        auto begun = begin(drawing, std::move(stop));
        if (!begun) return passOn(begun);
        return (*begun)->finish();
    }

    Expected<std::unique_ptr<PendingFrame>> begin(const Drawing& drawing, std::stop_token stop) override {
        try {
            const auto current = Context::Current::enter(*context_);
            if (!current) return passOn(current);
            return beginCurrent(drawing, std::move(stop));
        } catch (const std::bad_alloc&) {
            return fail(ErrorCode::ResourceLimit,
                        "There is not enough memory to draw this picture; ask for a smaller one.");
        }
    }

  private:
    /// Found out when the device opens.
    struct Findings {
        DriverStrings driver;
        Arithmetic arithmetic;
        SampleCacheOptions samples;
        std::uint64_t memoryForPictures = 0;  ///< bytes
    };

    GlDevice(std::shared_ptr<Context> context, const Findings& found, const GlOptions& options)
        : context_(std::move(context)),
          pool_(std::make_unique<DevicePool>(
              context_, options.programFolder, found.arithmetic, found.samples,
              splatLimits(context_->functions(), found.driver.software, options.sumTiles))),
          memory_(*context_, pool_->samples, uploadBudget(found.driver.software, options.uploadBudget)) {
        const DriverStrings& driver = found.driver;
        info_ = {context_->backend(), driver.vendor, driver.renderer, driver.version, !driver.software, {}};
        info_.identity = info_.name + "; " + driver.renderer + "; " + driver.version;
        info_.mirrors = true;
        info_.memory = driver.memory;
        info_.atomics64 = driver.atomics64;
        info_.exact = found.arithmetic.exact;
        info_.tellsLoss = driver.tellsLoss;
        pixelsAtOnce_ = scancast::gl::pixelsAtOnce(
            {driver.software, found.memoryForPictures, pool_->splats.limits().storageBlockBytes});
    }

    Expected<void> check(const Drawing& drawing) const {
        if (auto ok = checkDrawing(drawing); !ok) return ok;
        const Window& w = drawing.window;
        if (std::int64_t{w.width} * w.height * 4 <= std::int64_t(pool_->splats.limits().storageBlockBytes))
            return {};
        return fail(ErrorCode::ResourceLimit, fmt::format("A window of {} x {} pixels does not fit a storage "
                                                          "block of this OpenGL driver; draw it in parts.",
                                                          w.width, w.height));
    }

    Expected<std::unique_ptr<PendingFrame>> beginCurrent(const Drawing& drawing, std::stop_token stop) {
        if (auto ok = check(drawing); !ok) return passOn(ok);
        const auto passes = framePasses(drawing.passes);
        if (!passes) return passOn(passes);
        Frame frame;
        StageTimes times(pool_->timers);
        auto pixels = Picture(*pool_, drawing, *passes, stop).draw(times);
        if (!pixels) return passOn(pixels);
        frame.width = drawing.window.width;
        frame.height = drawing.window.height;
        tell(drawing, frame.stats);
        return std::make_unique<GlPicture>(*context_, std::move(*pixels), std::move(times), std::move(frame),
                                           std::move(stop));
    }

    void tell(const Drawing& drawing, FrameStats& stats) {
        const std::uint64_t uploaded = pool_->samples.bytesUploaded();
        stats.bytesUploaded = uploaded - std::exchange(bytesUploaded_, uploaded);
        stats.deviceBytes = pool_->samples.bytes();
        scancast::tellCuts(drawing.cuts, stats);
        stats.device = info_.name;
    }

    const std::shared_ptr<Context> context_;  ///< its pictures' loans keep it, too
    std::unique_ptr<DevicePool> pool_;
    GlMemory memory_;
    std::uint64_t bytesUploaded_ = 0;  ///< up to the last picture
    DeviceInfo info_;
    std::int64_t pixelsAtOnce_ = 0;
};

/// What opens is described by its driver; what does not, by why.
DeviceInfo describe(const char* backend, const EglDevice& egl,
                    const Expected<std::unique_ptr<Device>>& device) {
    DeviceInfo info;
    if (device) {
        info = (*device)->info();
    } else {
        info.name = backend;
        info.version = device.error().message;
    }
    info.eglDevice = egl.index;
    info.node = egl.node;
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
    if (!devices) return passOn(devices);
    std::string reasons;
    for (const gl::EglDevice& device : *devices) {
        if (device.software) continue;
        auto opened = createEglDevice(device.index, options);
        // A device without a driver of its own may fall back to a rasteriser.
        if (opened && (*opened)->info().hardware) return opened;
        reasons += opened ? fmt::format(" EGL device {} turned out to be {}.", device.index,
                                        (*opened)->info().renderer)
                          : " " + opened.error().message;
    }
    return fail(ErrorCode::DeviceUnavailable, "EGL finds no GPU here." + reasons);
}

std::vector<DeviceInfo> listGlDevices() {
    std::vector<DeviceInfo> infos;
    const auto devices = gl::listEglDevices();
    if (devices) {
        for (const gl::EglDevice& device : *devices)
            infos.push_back(gl::describe("egl", device, createEglDevice(device.index)));
    } else {
        infos.push_back(gl::describe("egl", {}, createEglDevice(-1)));
    }
    infos.push_back(gl::describe("osmesa", {}, createOsmesaDevice()));
    return infos;
}

}  // namespace scancast
