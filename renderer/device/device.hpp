// The interface of a rendering device: runs a list of passes over a cut. Two exist, `cpu` and `gl` (by EGL or
// OSMesa); each is the other's oracle. Pipeline: select → method's passes on **device** → frame.
//
// Owned by one thread, the render thread: every call comes from the thread that created it. A device may use
// more threads inside; its pictures do not depend on how many.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/view/view.hpp"
#include "renderer/device/pass.hpp"
#include "renderer/device/pause.hpp"
#include "renderer/device/pending_frame.hpp"
#include "renderer/image/frame.hpp"
#include "renderer/select/select.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

/// Brightness by intensity, docs/spec/shading.md §7: a channel becomes min(255, (channel · factor + 128) / 256),
/// in integers, with the factor at index = clamp((intensity - low) / (high - low)) · 255.
struct IntensityFactors {
    std::array<std::uint16_t, 256> factors{};
    double low = 0, high = 1;
};

/// How a sample becomes a colour, with everything looked up: no device knows colour maps or clouds.
struct ColorRule {
    ColorSource source = ColorSource::Rgb;  ///< neither Auto nor Visibility
    Rgb8 flat{255, 255, 255};
    /// 256 colours; index = clamp((value - low) / (high - low)) · 255 for intensity, elevation
    /// (cloud-relative z) and depth; classification and lod index it directly.
    std::array<Rgb8, 256> ramp{};
    double low = 0, high = 1;
    bool toned = false;  ///< of rgb and, always, of infrared: each channel c becomes ramp[c] of that channel
    std::optional<IntensityFactors> byIntensity{};
};

/// A convex piece of space, cloud-relative.
using Region = ConvexRegion;

/// Which samples may be drawn at all, beyond selection.
struct SampleFilter {
    std::optional<std::array<bool, 256>> classes;
    std::optional<ClipBox> clip;  ///< cloud-relative
    ClipRegions shapes;           ///< likewise; no sample outside of what they leave is drawn
    std::vector<Region> dropped;  ///< no sample inside any of these is drawn
    bool outliers = false;        ///< outliers (surfel_bytes.hpp) are drawn
};

struct Window {
    int x = 0, y = 0, width = 0, height = 0;  ///< part of the whole picture, px
};

/// A mirror in view, in the view space of the picture's own viewpoint. Where its rectangle lies at most
/// `margin` behind the scene, each pixel gets the reflected one's colour times the tint (its background
/// included), and the mirror's own depth: it is the mirror that is there, and that one can pick. Screen
/// passes look through it, as if its image stood behind an opening. docs/spec/mirrors.md §3.
struct MirrorGlass {
    glm::dvec3 center{0};  ///< of the rectangle
    glm::dvec3 normal{0};  ///< unit; out of the reflecting side
    glm::dvec3 right{0};   ///< half the width, and its direction
    glm::dvec3 up{0};      ///< half the height, and its direction
    Rgb8 tint{255, 255, 255};
    double margin = 0;  ///< cloud units
    Window bounds;      ///< no pixel outside is changed; may reach beyond the picture
};

/// The cloud as one eye sees it: the picture's own, or that eye's mirror image, which sees the same pixel of
/// the same picture.
struct CutView {
    Viewpoint viewpoint;                 ///< of a reflection: the picture's own, after the mirror
    Cut cut;                             ///< seen from there
    SampleFilter filter;                 ///< of a reflection: drops what lies behind the mirror, too
    std::optional<MirrorGlass> glass{};  ///< of a reflection; none: the main view
};

struct Drawing {
    std::span<const CutView> cuts;  ///< the main view, then its reflections
    /// The cloud as the sun sees it, for a ShadowPass; null: nothing is in the shadow. Orthographic; its picture is the map.
    const CutView* sun = nullptr;
    bool surfels = false;        ///< samples carry radii, ellipses and normals
    bool oriented = false;       ///< every normal's sign means something
    bool orientedNodes = false;  ///< those of nodes that are sure of it (sureSide) do
    bool curvatures = false;     ///< samples know theirs
    std::span<const Pass> passes;
    ColorRule color;
    Background background;
    Window window;                       ///< what to draw; the frame has its size
    std::span<const glm::dvec2> jitter;  ///< one sub-pixel shift (px) per anti-aliasing frame; at least one
    const Pause* pause = nullptr;        ///< lets others in meanwhile; null = nobody
    bool depth = true;                   ///< the frame shall have its depth; what only is encoded needs none

    const CutView& mainView() const { return cuts.front(); }
    std::span<const CutView> reflections() const { return cuts.subspan(1); }
};

struct DeviceInfo {
    std::string name;  ///< "cpu", "egl", "osmesa"
    std::string vendor, renderer, version;
    bool hardware = false;  ///< a real GPU
    std::string identity;   ///< what pictures may depend on, for ETags: "cpu" or the driver
    int eglDevice = -1;     ///< egl, as listed: what --egl-device calls it
    bool mirrors = false;   ///< draws reflections, and drops regions; Unsupported without
    std::string node{};     ///< egl: its file, "/dev/dri/renderD128"; empty = unknown
    std::uint64_t memory =
        0;  ///< of a GPU, bytes: all, or what is free if its driver tells no more; 0 = unknown
    bool atomics64 = false;  ///< egl, osmesa: finds the smallest of 64-bit integers in one step
    bool exact = true;       ///< rounds as IEEE 754 says: draws the cpu device's bytes
    bool pauses = false;     ///< within a picture, every few milliseconds; else between its tiles at most
    bool tellsLoss = true;   ///< says when its GPU was reset; else it is found lost when it does not answer
};

/// For people: "egl (NVIDIA H100 …)".
std::string title(const DeviceInfo& device);

class DeviceMemory;

class Device {
  public:
    virtual ~Device() = default;
    virtual DeviceInfo info() const = 0;
    /// Memory of its own that samples are moved to before they are drawn (renderer/residency); nullptr: it
    /// draws them where they are. Lives as long as the device.
    virtual DeviceMemory* memory() { return nullptr; }
    /// Pixels that a picture may have, whatever its shape, for it to be drawn in one piece rather than in
    /// tiles (renderer/render.hpp): in tiles nothing is read back while the next picture is begun, and every
    /// tile projects all samples. No byte depends on it. 0: no more than a tile.
    virtual std::int64_t pixelsAtOnce() const { return 0; }
    /// Draws one picture: for each jitter all passes, then the integer mean of the frames (colour weighted by
    /// coverage; depth is that of the first). Checks `stop` every few milliseconds: Cancelled leaves no
    /// trace. In its pauses (info().pauses) it is called again. Errors: Cancelled, ResourceLimit (picture or cut too large for the device), Unsupported,
    /// DeviceLost.
    virtual Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) = 0;
    /// The same in two steps, so that nobody waits for pixels who has something else to begin. Nothing that
    /// `drawing` refers to is needed afterwards. Several may be begun, and are finished in that order.
    /// Devices that draw at once need not do anything about it.
    virtual Expected<std::unique_ptr<PendingFrame>> begin(const Drawing& drawing, std::stop_token stop) {
        auto frame = draw(drawing, std::move(stop));
        if (!frame) return passOn(std::move(frame));
        return std::make_unique<DrawnFrame>(std::move(*frame));
    }
};

struct DeviceOptions {
    std::string backend = "auto";           ///< auto, cpu, egl, osmesa
    int threads = 0;                        ///< cpu: 0 = all cores
    int eglDevice = -1;                     ///< egl: index as listed; -1 = best
    std::filesystem::path programFolder{};  ///< egl, osmesa: keeps compiled programs; empty = compiled anew
    std::uint64_t gpuMemoryLimit = 0;  ///< egl, osmesa: bytes of samples at most; 0 = gl/memory_limit.hpp
    std::uint64_t uploadBudget =
        0;  ///< egl, osmesa: bytes a moving frame may upload; 0 = gl/memory_limit.hpp
    std::optional<bool> sumTiles{};  ///< egl, osmesa, for benchmarks: gl/programs/splat_limits.hpp
};

/// DeviceUnavailable names what is missing and how to get it.
Expected<std::unique_ptr<Device>> createDevice(const DeviceOptions& options);
/// What createDevice could open here, best first; entries that fail carry the reason in `version`.
std::vector<DeviceInfo> listDevices();

}  // namespace scancast
