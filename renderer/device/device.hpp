// The interface of a rendering device: runs a list of passes over a cut. Two exist, `cpu` and `gl` (by EGL or
// OSMesa); each is the other's oracle. Pipeline: select → method's passes on **device** → frame.
//
// Owned by one thread, the render thread: every call comes from the thread that created it. A device may use
// more threads inside; its pictures do not depend on how many.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/view.hpp"
#include "renderer/device/pass.hpp"
#include "renderer/image/frame.hpp"
#include "renderer/select/select.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

/// How a sample becomes a colour, with everything looked up: no device knows colour maps or clouds.
struct ColorRule {
    ColorSource source = ColorSource::Rgb;
    Rgb8 flat{255, 255, 255};
    /// 256 colours; index = clamp((value - low) / (high - low)) · 255 for intensity, elevation
    /// (cloud-relative z) and depth; classification and lod index it directly.
    std::array<Rgb8, 256> ramp{};
    double low = 0, high = 1;
};

/// Which samples may be drawn at all, beyond selection.
struct SampleFilter {
    std::optional<std::array<bool, 256>> classes;
    std::optional<ClipBox> clip;  ///< cloud-relative
};

struct Window {
    int x = 0, y = 0, width = 0, height = 0;  ///< part of the whole picture, px
};

struct Drawing {
    const Viewpoint* viewpoint = nullptr;
    const Cut* cut = nullptr;
    std::span<const Pass> passes;
    ColorRule color;
    SampleFilter filter;
    Background background;
    Window window;                       ///< what to draw; the frame has its size
    std::span<const glm::dvec2> jitter;  ///< one sub-pixel shift (px) per anti-aliasing frame; at least one
};

struct DeviceInfo {
    std::string name;  ///< "cpu", "egl", "osmesa"
    std::string vendor, renderer, version;
    bool hardware = false;  ///< a real GPU
    std::string identity;   ///< what pictures may depend on, for ETags: "cpu" or the driver
    int eglDevice = -1;     ///< egl, as listed: what --egl-device calls it
};

class Device {
  public:
    virtual ~Device() = default;
    virtual DeviceInfo info() const = 0;
    /// Draws one picture: for each jitter all passes, then the integer mean of the frames (colour weighted by
    /// coverage; depth is that of the first). Checks `stop` every few milliseconds: Cancelled leaves no
    /// trace. Errors: Cancelled, ResourceLimit (picture or cut too large for the device), Unsupported,
    /// DeviceLost.
    virtual Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) = 0;
};

struct DeviceOptions {
    std::string backend = "auto";  ///< auto, cpu, egl, osmesa
    int threads = 0;               ///< cpu: 0 = all cores
    int eglDevice = -1;            ///< egl: index as listed; -1 = best
};

/// DeviceUnavailable names what is missing and how to get it.
Expected<std::unique_ptr<Device>> createDevice(const DeviceOptions& options);
/// What createDevice could open here, best first; entries that fail carry the reason in `version`.
std::vector<DeviceInfo> listDevices();

}  // namespace scancast
