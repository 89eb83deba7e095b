// The `gl` device: every pass a compute shader on OpenGL 4.5 core, without a window, by EGL or OSMesa.
//
// A picture in three steps: lay out what it asks of the GPU (draw_plan.hpp), run the passes once per
// anti-aliasing frame (gl_passes.hpp), read back and average. The context is current only inside calls, so
// several GL devices may live on one thread.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "renderer/device/device.hpp"

namespace scancast {

/// What is not the context's: see DeviceOptions.
struct GlOptions {
    std::filesystem::path programFolder{};  ///< empty = nothing is kept from run to run
};

/// `device` as listed by listEglDevices(); -1 = best. DeviceUnavailable says what is missing and how to get
/// it.
Expected<std::unique_ptr<Device>> createEglDevice(int device, const GlOptions& options = {});
Expected<std::unique_ptr<Device>> createOsmesaDevice(const GlOptions& options = {});

/// Opens only what claims to be a GPU: quick where there is none.
Expected<std::unique_ptr<Device>> createHardwareEglDevice(const GlOptions& options = {});

/// Every EGL device, then OSMesa; what does not open carries the reason in `version`.
std::vector<DeviceInfo> listGlDevices();

}  // namespace scancast
